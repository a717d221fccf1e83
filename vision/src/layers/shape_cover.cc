#include "layers/shape_cover.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "touchdown/core/normal.h"

namespace touchdown::vision::layers {
namespace {

const NormalTable& Table() {
  static const NormalTable table;
  return table;
}

// A(u; h) and its derivatives by u, h and s.
struct Span {
  float value = 0.0F;
  float by_u = 0.0F;
  float by_half = 0.0F;
  float by_blur = 0.0F;
};

Span CoverSpan(const NormalTable& table, float u, float half, float per_blur) {
  const float right = (half - u) * per_blur;
  const float left = (half + u) * per_blur;
  float phi_right = 0.0F;
  float density_right = 0.0F;
  float phi_left = 0.0F;
  float density_left = 0.0F;
  table.Look(right, phi_right, density_right);
  table.Look(left, phi_left, density_left);
  return {phi_right + phi_left - 1.0F,
          (density_left - density_right) * per_blur,
          (density_left + density_right) * per_blur,
          -(right * density_right + left * density_left) * per_blur};
}

}  // namespace

double Shape::Reach() const {
  return disc ? half_long : std::hypot(half_long, half_short);
}

double Shape::Area() const {
  return disc ? std::numbers::pi * half_long * half_long
              : 4.0 * half_long * half_short;
}

NormalTable::NormalTable() {
  for (std::size_t i = 0; i < phi_.size(); ++i) {
    const double z = static_cast<double>(i) / kPerUnit - kReach;
    phi_[i] = static_cast<float>(core::NormalCdf(z));
    density_[i] = static_cast<float>(core::NormalDensity(z));
  }
}

ShapeCover::ShapeCover(const Shape& shape, double blur)
    : table_(Table()),
      disc_(shape.disc),
      half_long_(static_cast<float>(shape.half_long)),
      half_short_(static_cast<float>(shape.half_short)),
      per_blur_(static_cast<float>(1.0 / blur)),
      bend_(static_cast<float>(
          shape.disc ? 0.5 * blur / std::max(shape.half_long, blur) : 0.0)),
      by_long_(1.0F + bend_ / (half_long_ * per_blur_)) {
  const float rim = (NormalTable::kReach + bend_) / per_blur_;
  inside_long_ = std::max(0.0F, half_long_ - rim);
  inside_short_ = std::max(0.0F, half_short_ - rim);
  outside_long_ = half_long_ + rim;
  outside_short_ = half_short_ + rim;
}

CoverAt ShapeCover::CoverOfRectangle(float x, float y) const {
  CoverAt at;
  const Span along = CoverSpan(table_, x, half_long_, per_blur_);
  const Span across = CoverSpan(table_, y, half_short_, per_blur_);
  at.value = along.value * across.value;
  at.by_x = along.by_u * across.value;
  at.by_y = along.value * across.by_u;
  at.by_long = along.by_half * across.value;
  at.by_short = along.value * across.by_half;
  at.by_blur = along.by_blur * across.value + along.value * across.by_blur;
  return at;
}

RowPart ShapeCover::FindSeen(float down, float cosine, float sine) const {
  constexpr float kBlurs = 3.6F;  // Phi(-3.6) = 1.6e-4
  const float rim = kBlurs / per_blur_;
  if (disc_) {
    const float reach = half_long_ + rim;
    if (std::abs(down) > reach) return {};
    const float half = std::sqrt(reach * reach - down * down);
    return {-half, half};
  }
  RowPart seen{-half_long_ - half_short_ - 2.0F * rim,
               half_long_ + half_short_ + 2.0F * rim};
  // A slab |per x + at| <= half.
  const auto cut = [&seen](float per, float at, float half) {
    constexpr float kAlong = 1e-6F;  // the row runs along the slab
    if (std::abs(per) < kAlong) {
      if (std::abs(at) > half) seen = {};
      return;
    }
    const float one = (-half - at) / per;
    const float other = (half - at) / per;
    seen.from = std::max(seen.from, std::min(one, other));
    seen.to = std::min(seen.to, std::max(one, other));
  };
  cut(cosine, sine * down, half_long_ + rim);
  cut(-sine, cosine * down, half_short_ + rim);
  return seen;
}

Product ShapeCover::WithEdge(float x, float y, const StillEdge& edge,
                             float cosine, float sine) const {
  // Beyond so many blurs from its own edge the body has none.
  constexpr float kFar = 3.5F;
  Product product;
  // The still edge's normal in the body's coordinates.
  const float normal_x = cosine * edge.normal_x + sine * edge.normal_y;
  const float normal_y = cosine * edge.normal_y - sine * edge.normal_x;
  if (disc_) {
    const float distance = std::sqrt(x * x + y * y) + 1e-6F;
    const float z = (half_long_ - distance) * per_blur_ - bend_;
    if (std::abs(z) > kFar) return product;
    const float rho = -(normal_x * x + normal_y * y) / distance;
    product.value = edge.contrast * EdgeProduct(z, edge.z, rho);
    const float slope = -edge.contrast * per_blur_ *
                        EdgeProductSlope(z, edge.z, rho) / distance;
    product.by_x = slope * x;
    product.by_y = slope * y;
    return product;
  }
  // Each side by itself, as far as the other two let it be seen.
  const float along = CoverSpan(table_, x, half_long_, per_blur_).value;
  const float across = CoverSpan(table_, y, half_short_, per_blur_).value;
  const auto add = [&](float half, float at, float seen, float normal,
                       float& slope) {
    if (seen <= 1e-3F) return;
    for (const float side : {-1.0F, 1.0F}) {
      const float z = (half - side * at) * per_blur_;
      if (std::abs(z) >= kFar) continue;
      const float rho = -side * normal;
      product.value += edge.contrast * seen * EdgeProduct(z, edge.z, rho);
      slope -= side * per_blur_ * edge.contrast * seen *
               EdgeProductSlope(z, edge.z, rho);
    }
  };
  add(half_long_, x, across, normal_x, product.by_x);
  add(half_short_, y, along, normal_y, product.by_y);
  return product;
}

}  // namespace touchdown::vision::layers
