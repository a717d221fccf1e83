#include "layers/disc_turn.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace touchdown::vision::layers {
namespace {

constexpr double kCircle = 2.0 * std::numbers::pi;  // rad

// Cells of a circle: 3 degrees. The peak of a correlation lies between cells,
// by a parabola. More cost time with their square. Not studied.
constexpr std::size_t kCells = 120;

// The circles: inside of the blurred edge, and so far from the centre that a
// turn moves something.
struct Circles {
  std::vector<double> radius_px;
  std::vector<float> pixels;  // of the picture that each cell stands for
  double all_pixels = 0.0;
};

Circles ChooseCircles(const Shape& disc, double blur_px) {
  constexpr double kRimBlurs = 3.0;        // beyond, the edge has a say
  constexpr double kLeastRadius_px = 2.0;  // nearer, a cell is no pixel
  // More tell nothing new, since levels of neighbours are alike.
  constexpr double kMostCircles = 24.0;
  const double outer = disc.half_long - kRimBlurs * blur_px;
  const double apart = std::max(1.0, outer / kMostCircles);
  Circles circles;
  const double inner = std::max(kLeastRadius_px, apart);
  const int count = static_cast<int>(std::floor((outer - inner) / apart)) + 1;
  for (int k = 0; k < count; ++k) {
    const double r = inner + k * apart;
    circles.radius_px.push_back(r);
    circles.pixels.push_back(static_cast<float>(kCircle * r * apart / kCells));
    circles.all_pixels += kCircle * r * apart;
  }
  return circles;
}

struct Part {  // of the circles
  std::size_t begin = 0;
  std::size_t end = 0;
};

// Levels on all circles, one after the other.
using Face = std::vector<float>;

// Nothing where the disc reaches beyond what is held of the picture.
std::optional<Face> SampleFace(const PictureStack& stack, std::size_t picture,
                               const Circles& circles, const LayerPose& pose) {
  Face face;
  face.reserve(circles.radius_px.size() * kCells);
  for (const double r : circles.radius_px) {
    for (std::size_t k = 0; k < kCells; ++k) {
      const double angle = kCircle * static_cast<double>(k) / kCells;
      const auto level = stack.LevelAt(picture, pose.x + r * std::cos(angle),
                                       pose.y + r * std::sin(angle));
      if (!level) return std::nullopt;
      face.push_back(*level);
    }
  }
  return face;
}

// Takes the first harmonics out of each circle.
void RemoveSmooth(Face& face) {
  // 0, 1 and 2: a slope over the face is the first, a bend the second. More
  // takes marks away, too. Not studied.
  constexpr int kHarmonics = 3;
  for (std::size_t from = 0; from < face.size(); from += kCells) {
    for (int m = 0; m < kHarmonics; ++m) {
      const auto angle_at = [m](std::size_t k) {
        return kCircle * m * static_cast<double>(k) / kCells;
      };
      double cosine = 0.0;
      double sine = 0.0;
      for (std::size_t k = 0; k < kCells; ++k) {
        cosine += static_cast<double>(face[from + k]) * std::cos(angle_at(k));
        sine += static_cast<double>(face[from + k]) * std::sin(angle_at(k));
      }
      const double share = (m == 0 ? 1.0 : 2.0) / kCells;
      for (std::size_t k = 0; k < kCells; ++k) {
        face[from + k] -=
            static_cast<float>(share * (cosine * std::cos(angle_at(k)) +
                                        sine * std::sin(angle_at(k))));
      }
    }
  }
}

// The faces of the pictures that show them whole. None where there are too few
// of them, or of the circles.
struct Faces {
  std::vector<Face> faces;
  std::vector<std::size_t> pictures;  // that they are of
};
Faces SampleFaces(const PictureStack& stack, const Circles& circles,
                  const std::vector<LayerPose>& poses) {
  // Two halves need a circle each, and one to spare. Not studied.
  constexpr std::size_t kLeastCircles = 3;
  // Fewer pictures do not tell a turn from chance. Not studied.
  constexpr std::size_t kLeastFaces = 5;
  Faces whole;
  if (circles.pixels.size() < kLeastCircles) return whole;
  for (std::size_t t = 0; t < poses.size(); ++t) {
    auto face = SampleFace(stack, t, circles, poses[t]);
    if (!face) continue;
    RemoveSmooth(*face);
    whole.faces.push_back(std::move(*face));
    whole.pictures.push_back(t);
  }
  if (whole.faces.size() < kLeastFaces) return {};
  return whole;
}

// Adds a face turned back by `angle`, to the nearest cell: a mean of two cells
// would take noise for a better fit.
void AddTurnedBack(const Face& face, double angle, Face& sum) {
  const double turns = angle / kCircle;
  const auto cells = static_cast<std::size_t>(
      std::lround((turns - std::floor(turns)) * kCells));
  for (std::size_t from = 0; from < face.size(); from += kCells) {
    for (std::size_t k = 0; k < kCells; ++k) {
      sum[from + k] += face[from + (k + cells) % kCells];
    }
  }
}

// By how much `face` has turned from `picture`, as a part of the circles shows
// it: the cell of the greatest correlation and the peak of the parabola about
// it.
double FindTurn(const Face& face, const Face& picture, const Circles& circles,
                const Part& part) {
  // Once more after its end, so that a shifted circle is one stretch.
  std::vector<float> correlation(kCells, 0.0F);
  std::vector<float> twice(2 * kCells);
  for (std::size_t c = part.begin; c < part.end; ++c) {
    const float* const own = face.data() + c * kCells;
    std::copy_n(own, kCells, twice.begin());
    std::copy_n(own, kCells, twice.begin() + kCells);
    const float* const of = picture.data() + c * kCells;
    for (std::size_t shift = 0; shift < kCells; ++shift) {
      float sum = 0.0F;
      for (std::size_t k = 0; k < kCells; ++k) sum += of[k] * twice[k + shift];
      correlation[shift] += circles.pixels[c] * sum;
    }
  }
  const auto best = static_cast<std::size_t>(
      std::max_element(correlation.begin(), correlation.end()) -
      correlation.begin());
  const auto at = [&](std::size_t k) {
    return static_cast<double>(correlation[k % kCells]);
  };
  const double before = at(best + kCells - 1);
  const double after = at(best + 1);
  const double bend = before - 2.0 * at(best) + after;
  const double beyond = bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
  return kCircle * (static_cast<double>(best) + beyond) / kCells;
}

// The mean of all faces, turned back.
Face MeanFace(const std::vector<Face>& faces,
              const std::vector<double>& angles) {
  Face mean(faces.front().size(), 0.0F);
  for (std::size_t t = 0; t < faces.size(); ++t) {
    AddTurnedBack(faces[t], angles[t], mean);
  }
  for (float& level : mean) level /= static_cast<float>(faces.size());
  return mean;
}

// What is left of all faces, turned back, beside their mean, in a part of the
// circles.
double SumOfSquares(const std::vector<Face>& faces,
                    const std::vector<double>& angles, const Circles& circles,
                    const Part& part) {
  const Face mean = MeanFace(faces, angles);
  double sum = 0.0;
  Face back(mean.size());
  for (std::size_t t = 0; t < faces.size(); ++t) {
    std::fill(back.begin(), back.end(), 0.0F);
    AddTurnedBack(faces[t], angles[t], back);
    for (std::size_t i = part.begin * kCells; i < part.end * kCells; ++i) {
      const float off = back[i] - mean[i];
      sum += static_cast<double>(circles.pixels[i / kCells] * off * off);
    }
  }
  return sum;
}

// The angles that a part of the circles shows.
std::vector<double> FollowFace(const std::vector<Face>& faces,
                               const Circles& circles, const Part& part) {
  std::vector<double> angles(faces.size(), 0.0);
  Face picture = faces.front();
  for (std::size_t t = 1; t < faces.size(); ++t) {
    angles[t] = FindTurn(faces[t], picture, circles, part);
    AddTurnedBack(faces[t], angles[t], picture);
  }
  double least = SumOfSquares(faces, angles, circles, part);
  // A bound on time; most rest after three.
  constexpr int kMostRounds = 8;
  for (int round = 0; round < kMostRounds; ++round) {
    picture = MeanFace(faces, angles);
    std::vector<double> better;
    better.reserve(faces.size());
    for (const Face& face : faces) {
      better.push_back(FindTurn(face, picture, circles, part));
    }
    const double sum = SumOfSquares(faces, better, circles, part);
    if (!(sum < least)) break;
    least = sum;
    angles = std::move(better);
  }
  return angles;
}

// By how much the log likelihood of the circles that were not asked grows, in
// a face that turns by what the others show.
double HeldOutGain(const std::vector<Face>& faces, const Circles& circles,
                   const Part& asked, const Part& other) {
  const std::vector<double> still(faces.size(), 0.0);
  double pixels = 0.0;
  for (std::size_t c = other.begin; c < other.end; ++c) {
    pixels += static_cast<double>(kCells) *
              static_cast<double>(circles.pixels[c]) *
              static_cast<double>(faces.size());
  }
  return 0.5 * pixels *
         std::log(SumOfSquares(faces, still, circles, other) /
                  SumOfSquares(faces, FollowFace(faces, circles, asked),
                               circles, other));
}

// Angles of pictures of which some have one: between two of them, and beyond
// the ends, along straight lines.
std::vector<double> Interpolate(const std::vector<std::int64_t>& frames,
                                const std::vector<std::size_t>& known,
                                const std::vector<double>& angles) {
  std::vector<double> all;
  std::size_t next = 1;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    while (next + 1 < known.size() && known[next] < t) ++next;
    const auto begin = static_cast<double>(frames[known[next - 1]]);
    const auto end = static_cast<double>(frames[known[next]]);
    const double share =
        (static_cast<double>(frames[t]) - begin) / (end - begin);
    all.push_back(angles[next - 1] + share * (angles[next] - angles[next - 1]));
  }
  return all;
}

// Each angle within half a turn of the one before it.
void Unwind(std::vector<double>& angles) {
  for (std::size_t t = 1; t < angles.size(); ++t) {
    angles[t] =
        angles[t - 1] + std::remainder(angles[t] - angles[t - 1], kCircle);
  }
}

}  // namespace

double MeasureFaceChange(const PictureStack& stack, const Shape& disc,
                         double blur_px, const std::vector<LayerPose>& poses) {
  const Circles circles = ChooseCircles(disc, blur_px);
  const std::vector<Face> faces = SampleFaces(stack, circles, poses).faces;
  if (faces.empty()) return 0.0;
  const std::vector<double> still(faces.size(), 0.0);
  return SumOfSquares(faces, still, circles, {0, circles.pixels.size()}) /
         (circles.all_pixels * static_cast<double>(faces.size() - 1));
}

std::optional<std::vector<double>> FindTurns(
    const PictureStack& stack, const Shape& disc, double blur_px,
    double noise_dn, const std::vector<LayerPose>& poses) {
  const Circles circles = ChooseCircles(disc, blur_px);
  const Faces whole = SampleFaces(stack, circles, poses);
  const std::vector<Face>& faces = whole.faces;
  if (faces.empty()) return std::nullopt;
  // An inner and an outer part of as many pixels: each must show the turns of
  // the other, which noise does not.
  const std::size_t all = circles.pixels.size();
  std::size_t half = 0;
  for (double inner = 0.0; inner < 0.5 * circles.all_pixels; ++half) {
    inner +=
        static_cast<double>(kCells) * static_cast<double>(circles.pixels[half]);
  }
  half = std::min(half, all - 1);
  const double gain = HeldOutGain(faces, circles, {0, half}, {half, all}) +
                      HeldOutGain(faces, circles, {half, all}, {0, half});
  // Of a picture, in nats. Two pictures of noise differ by some tens in all; a
  // face that moves an outline by 0.01 px has hundreds. Not studied.
  constexpr double kLeastGain = 10.0;
  if (!(gain > kLeastGain * static_cast<double>(faces.size()))) {
    return std::nullopt;
  }
  std::vector<double> angles = FollowFace(faces, circles, {0, all});
  // Of what changes in the face beyond noise: more that is left tells of
  // another motion than a turn in the plane of the picture, or of light that
  // plays on a rough face. Five golf balls leave 0.38 to 0.49 of it, three
  // photographed faces 0.02 and less.
  constexpr double kMostLeft = 0.25;
  const double noise = noise_dn * noise_dn * circles.all_pixels *
                       static_cast<double>(faces.size());
  const std::vector<double> at_rest(faces.size(), 0.0);
  const auto left = [&](const std::vector<double>& turned) {
    return SumOfSquares(faces, turned, circles, {0, all}) - noise;
  };
  if (left(angles) > kMostLeft * left(at_rest)) return std::nullopt;
  const double first = angles.front();
  for (double& angle : angles) angle -= first;
  Unwind(angles);
  return Interpolate(stack.frames, whole.pictures, angles);
}

}  // namespace touchdown::vision::layers
