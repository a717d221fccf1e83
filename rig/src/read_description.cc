// rig.toml -> Description. toml++ stays in this file.
#include <fmt/core.h>
#include <toml++/toml.h>

#include <cmath>
#include <fstream>
#include <initializer_list>
#include <sstream>

#include "infinity.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/description.h"

namespace touchdown::rig {
namespace {

using core::Estimate;

// What a number may be; the words appear in errors.
struct Range {
  double low = -kInf;
  double high = kInf;
  bool open_low = false;  // low itself is not allowed
  const char* words = "a finite number";

  bool Contains(double v) const {
    return std::isfinite(v) && (open_low ? v > low : v >= low) && v <= high;
  }
};

// Ranges of values in the file's own units, with the words that messages use.
constexpr Range kAny{};
constexpr Range kPositive{0.0, kInf, true, "positive"};
constexpr Range kAtLeastZero{0.0, kInf, false, "at least 0"};
constexpr Range kWithinQuarterTurn{-90.0, 90.0, false, "within -90 .. 90"};
constexpr Range kEfficiency{0.0, 2.0, true, "in (0, 2]"};

// A table of the file, with the file's name for errors.
class Section {
 public:
  Section(std::string_view file, std::string name, const toml::table& table)
      : file_(file), name_(std::move(name)), table_(table) {}

  [[noreturn]] void Fail(const toml::source_region& at,
                         const std::string& what) const {
    throw core::InputError(
        fmt::format("{}:{}: {}", file_, at.begin.line, what));
  }

  [[noreturn]] void FailHere(const std::string& what) const {
    Fail(table_.source(), what);
  }

  std::string Full(std::string_view key) const {
    return name_.empty() ? std::string(key) : fmt::format("{}.{}", name_, key);
  }

  void Allow(std::initializer_list<std::string_view> known) const {
    for (const auto& [key, node] : table_) {
      if (std::find(known.begin(), known.end(), key.str()) != known.end()) {
        continue;
      }
      std::string list;
      for (const std::string_view word : known) {
        list += list.empty() ? "" : ", ";
        list += word;
      }
      Fail(key.source(), fmt::format("unknown key {}, expected one of: {}",
                                     Full(key.str()), list));
    }
  }

  bool Has(std::string_view key) const { return table_.contains(key); }

  const toml::node& Need(std::string_view key) const {
    if (const toml::node* node = table_.get(key)) return *node;
    FailHere(fmt::format("{} is missing", Full(key)));
  }

  std::string Text(std::string_view key) const {
    const toml::node& node = Need(key);
    if (const auto* text = node.as_string()) return text->get();
    Fail(node.source(), fmt::format("{} must be a string", Full(key)));
  }

  double Plain(std::string_view key, const Range& range, double unit) const {
    return Number(key, Need(key), range) * unit;
  }

  double PlainOr(std::string_view key, const Range& range, double unit,
                 double otherwise) const {
    return Has(key) ? Plain(key, range, unit) : otherwise;
  }

  // Plain, or { value, u }; into SI by `unit`. A plain one has `plain_u` of its
  // value as u.
  Estimate Measured(std::string_view key, const Range& range, double unit,
                    double plain_u = 0.0) const {
    const toml::node& node = Need(key);
    const toml::table* table = node.as_table();
    if (table == nullptr) {
      const double value = Number(key, node, range) * unit;
      return {value, plain_u * std::abs(value), {}};
    }
    const Section inner(file_, Full(key), *table);
    inner.Allow({"value", "u"});
    return {inner.Plain("value", range, unit),
            inner.PlainOr("u", kAtLeastZero, unit, 0.0),
            {}};
  }

  Estimate MeasuredOr(std::string_view key, const Range& range, double unit,
                      const Estimate& otherwise) const {
    return Has(key) ? Measured(key, range, unit) : otherwise;
  }

  Section Table(std::string_view key) const {
    const toml::node& node = Need(key);
    if (const auto* table = node.as_table()) return {file_, Full(key), *table};
    Fail(node.source(), fmt::format("{} must be a table: [{}]", key, key));
  }

  const toml::source_region& At(std::string_view key) const {
    return Need(key).source();
  }

 private:
  double Number(std::string_view key, const toml::node& node,
                const Range& range) const {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value) {
      Fail(node.source(), fmt::format("{} must be a number", Full(key)));
    }
    if (!range.Contains(*value)) {
      Fail(node.source(), fmt::format("{} is {:g}, must be {}", Full(key),
                                      *value, range.words));
    }
    return *value;
  }

  std::string_view file_;
  std::string name_;
  const toml::table& table_;
};

SpringGeometry ReadGeometry(const Section& in) {
  // GPa to Pa.
  constexpr double kGiga = 1e9;
  SpringGeometry out;
  out.shear_modulus_pa = in.Measured("shear_modulus_gpa", kPositive, kGiga);
  out.wire_diameter_m =
      in.Measured("wire_diameter_mm", kPositive, core::kMillimetre);
  out.coil_diameter_m =
      in.Measured("coil_diameter_mm", kPositive, core::kMillimetre);
  const std::string kind = in.Text("coil_diameter_kind");
  const auto parsed = ParseCoilDiameter(kind);
  if (!parsed) {
    in.Fail(in.At("coil_diameter_kind"),
            fmt::format("springs.coil_diameter_kind is \"{}\", must be mean, "
                        "outer or inner",
                        kind));
  }
  out.coil_diameter = *parsed;
  out.active_coils = in.Measured("active_coils", kPositive, 1.0);
  // Both ends closed, the usual make: one dead coil each.
  constexpr double kDeadCoils = 2.0;
  out.total_coils = in.PlainOr("total_coils", kPositive, 1.0,
                               out.active_coils.value + kDeadCoils);
  if (out.total_coils < out.active_coils.value) {
    in.Fail(in.At("total_coils"),
            fmt::format("springs.total_coils is {:g}, must be at least "
                        "active_coils ({:g})",
                        out.total_coils, out.active_coils.value));
  }
  out.density_kg_per_m3 =
      in.PlainOr("density_kg_per_m3", kPositive, 1.0, out.density_kg_per_m3);
  return out;
}

Springs ReadSprings(const Section& in) {
  in.Allow({"count", "shear_modulus_gpa", "wire_diameter_mm",
            "coil_diameter_mm", "coil_diameter_kind", "active_coils",
            "total_coils", "density_kg_per_m3", "free_length_mm",
            "allowable_shear_mpa", "stiffness_n_per_m", "mass_g"});
  Springs out;
  if (in.Has("count")) {
    const double count = in.Plain("count", kPositive, 1.0);
    // Springs: more are a typing error. Not studied.
    constexpr double kMaxSprings = 1000.0;
    if (count != std::floor(count) || count > kMaxSprings) {
      in.Fail(in.At("count"),
              fmt::format("springs.count is {:g}, must be a whole number, 1 .. "
                          "{:g}",
                          count, kMaxSprings));
    }
    out.count = static_cast<int>(count);
  }
  if (in.Has("stiffness_n_per_m")) {
    out.stiffness_n_per_m = in.Measured("stiffness_n_per_m", kPositive, 1.0);
  }
  bool any = false;
  for (const char* key :
       {"shear_modulus_gpa", "wire_diameter_mm", "coil_diameter_mm",
        "coil_diameter_kind", "active_coils"}) {
    any = any || in.Has(key);
  }
  if (any || !out.stiffness_n_per_m) {
    out.geometry = ReadGeometry(in);
    try {
      (void)SpringIndex(*MakeSpring(out));
    } catch (const std::invalid_argument& error) {
      in.Fail(in.At("coil_diameter_mm"),
              fmt::format("springs: {}", error.what()));
    }
  }
  if (in.Has("mass_g")) out.mass_kg = in.Measured("mass_g", kAtLeastZero, 1e-3);
  if (in.Has("free_length_mm")) {
    out.free_length_m =
        in.Plain("free_length_mm", kPositive, core::kMillimetre);
  }
  if (in.Has("allowable_shear_mpa")) {
    out.allowable_shear_pa = in.Plain("allowable_shear_mpa", kPositive, 1e6);
  }
  return out;
}

void ReadEjector(const Section& in, Description& out) {
  in.Allow({"preload_mm", "compression_max_mm", "u_compression_mm",
            "efficiency", "loss_j", "barrel_friction"});
  out.preload_m = in.MeasuredOr("preload_mm", kAtLeastZero, core::kMillimetre,
                                out.preload_m);
  if (in.Has("compression_max_mm")) {
    out.compression_max_m =
        in.Plain("compression_max_mm", kPositive, core::kMillimetre);
  }
  out.u_compression_m =
      in.PlainOr("u_compression_mm", kAtLeastZero, core::kMillimetre, 0.0);
  out.efficiency =
      in.MeasuredOr("efficiency", kEfficiency, 1.0, out.efficiency);
  out.loss_j = in.MeasuredOr("loss_j", kAtLeastZero, 1.0, out.loss_j);
  out.barrel_friction =
      in.MeasuredOr("barrel_friction", kAtLeastZero, 1.0, out.barrel_friction);
}

void ReadMuzzle(const Section& in, Description& out) {
  in.Allow({"elevation_min_deg", "elevation_max_deg", "u_elevation_deg",
            "height_min_mm", "height_max_mm", "u_height_mm"});
  out.elevation_min_rad =
      in.Plain("elevation_min_deg", kWithinQuarterTurn, core::kDegree);
  out.elevation_max_rad =
      in.Plain("elevation_max_deg", kWithinQuarterTurn, core::kDegree);
  if (out.elevation_max_rad < out.elevation_min_rad) {
    in.Fail(in.At("elevation_max_deg"),
            "muzzle.elevation_max_deg is less than elevation_min_deg");
  }
  out.u_elevation_rad =
      in.PlainOr("u_elevation_deg", kAtLeastZero, core::kDegree, 0.0);
  out.muzzle_height_min_m =
      in.Plain("height_min_mm", kAtLeastZero, core::kMillimetre);
  out.muzzle_height_max_m =
      in.Plain("height_max_mm", kAtLeastZero, core::kMillimetre);
  if (out.muzzle_height_max_m < out.muzzle_height_min_m) {
    in.Fail(in.At("height_max_mm"),
            "muzzle.height_max_mm is less than height_min_mm");
  }
  out.u_muzzle_height_m =
      in.PlainOr("u_height_mm", kAtLeastZero, core::kMillimetre, 0.0);
}

// Relative u of a body's size that is given plain, as of every plain size and
// scale of the program: a caliper's 0.02 mm on 20 mm.
constexpr double kPlainSizeU = 1e-3;

void ReadBody(const Section& in, Description& out) {
  const std::string kind = in.Text("kind");
  if (kind == "sphere") {
    in.Allow({"kind", "mass_g", "diameter_mm"});
    out.body = core::Sphere(
        in.Measured("diameter_mm", kPositive, core::kMillimetre, kPlainSizeU));
  } else if (kind == "rectangle") {
    in.Allow({"kind", "mass_g", "long_mm", "short_mm", "seat_angle_deg",
              "spin_deg_per_s"});
    const Estimate a =
        in.Measured("long_mm", kPositive, core::kMillimetre, kPlainSizeU);
    const Estimate b =
        in.Measured("short_mm", kPositive, core::kMillimetre, kPlainSizeU);
    // core::Rectangle would swap them silently; the seat angle belongs to the
    // long side, so the names must be right.
    if (a.value < b.value) {
      in.Fail(in.At("long_mm"), "body.long_mm is less than body.short_mm");
    }
    out.body = core::Rectangle(a, b);
    out.seat_angle_rad = in.MeasuredOr("seat_angle_deg", kWithinQuarterTurn,
                                       core::kDegree, out.seat_angle_rad);
    out.spin_rad_per_s = in.MeasuredOr("spin_deg_per_s", kAny, core::kDegree,
                                       out.spin_rad_per_s);
  } else {
    in.Fail(
        in.At("kind"),
        fmt::format("body.kind is \"{}\", must be sphere or rectangle", kind));
  }
  out.mass_kg = in.Measured("mass_g", kPositive, 1e-3);
}

}  // namespace

Description ParseDescription(std::string_view text, std::string_view name) {
  toml::table table;
  try {
    table = toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw core::InputError(fmt::format("{}:{}: not valid TOML: {}", name,
                                       error.source().begin.line,
                                       error.description()));
  }
  const Section root(name, "", table);
  root.Allow(
      {"schema", "name", "springs", "ejector", "muzzle", "body", "site"});
  // The file's kind and version; another is refused.
  constexpr std::string_view kSchema = "touchdown.rig/1";
  if (const std::string schema = root.Text("schema"); schema != kSchema) {
    root.Fail(
        root.At("schema"),
        fmt::format("schema is \"{}\", expected \"{}\"", schema, kSchema));
  }
  Description out;
  if (root.Has("name")) out.name = root.Text("name");
  out.springs = ReadSprings(root.Table("springs"));
  if (root.Has("ejector")) ReadEjector(root.Table("ejector"), out);
  ReadMuzzle(root.Table("muzzle"), out);
  ReadBody(root.Table("body"), out);
  if (root.Has("site")) {
    const Section site = root.Table("site");
    site.Allow({"gravity_mps2"});
    out.gravity_mps2 =
        site.MeasuredOr("gravity_mps2", kPositive, 1.0, out.gravity_mps2);
  }
  return out;
}

Description ReadDescription(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf())) {
    throw core::InputError(
        path.string() +
        ": cannot be read, expected a rig description; `touchdown rig example` "
        "prints one");
  }
  return ParseDescription(text.str(), path.string());
}

}  // namespace touchdown::rig
