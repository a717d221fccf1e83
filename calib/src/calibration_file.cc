#include "touchdown/calib/calibration_file.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "touchdown/calib/lens_directions.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/output_file.h"
#include "touchdown/core/units.h"

namespace touchdown::calib {
namespace {

using Json = nlohmann::ordered_json;

// The file's kind and version; another is refused.
constexpr const char* kSchema = "touchdown.calibration/1";

// One object of the file and where it stands.
class Object {
 public:
  Object(const Json& value, std::string source, std::string path)
      : value_(value), source_(std::move(source)), path_(std::move(path)) {
    if (!value_.is_object()) Fail("", "must be an object");
  }

  [[noreturn]] void Fail(const std::string& name,
                         const std::string& expected) const {
    throw core::InputError(
        fmt::format("{}: {}/{} {}; `touchdown calibrate` writes such files",
                    source_, path_, name, expected));
  }
  bool Has(const std::string& name) const {
    return value_.contains(name) && !value_.at(name).is_null();
  }
  const Json& Member(const std::string& name) const {
    if (!value_.contains(name)) Fail(name, "is missing");
    return value_.at(name);
  }
  Object Child(const std::string& name) const {
    return {Member(name), source_, path_ + "/" + name};
  }
  double Number(const std::string& name) const {
    const Json& member = Member(name);
    if (!member.is_number() || !std::isfinite(member.get<double>())) {
      Fail(name, fmt::format("is {}, must be a finite number", member.dump()));
    }
    return member.get<double>();
  }
  double NotNegative(const std::string& name) const {
    const double value = Number(name);
    if (!(value >= 0.0)) {
      Fail(name, fmt::format("is {}, must be at least 0", value));
    }
    return value;
  }
  double Positive(const std::string& name) const {
    const double value = Number(name);
    if (!(value > 0.0)) {
      Fail(name, fmt::format("is {}, must be positive", value));
    }
    return value;
  }
  std::int32_t Whole(const std::string& name, std::int32_t least) const {
    const Json& member = Member(name);
    // Beyond any camera's sides and any number of pictures: larger numbers are
    // damage.
    constexpr std::int64_t kMaxWhole = 1 << 20;
    if (!member.is_number_integer() || member.get<std::int64_t>() < least ||
        member.get<std::int64_t>() > kMaxWhole) {
      Fail(name, fmt::format("is {}, must be a whole number of {} .. {}",
                             member.dump(), least, kMaxWhole));
    }
    return member.get<std::int32_t>();
  }
  std::string Word(const std::string& name) const {
    const Json& member = Member(name);
    if (!member.is_string()) {
      Fail(name, fmt::format("is {}, must be a text", member.dump()));
    }
    return member.get<std::string>();
  }
  std::string Date(const std::string& name) const {
    std::string date = Word(name);
    if (!IsDate(date)) {
      Fail(name, fmt::format("is '{}', must be a day as in 2026-11-21", date));
    }
    return date;
  }
  core::Estimate Estimate(const std::string& name, double unit = 1.0) const {
    const Object e = Child(name);
    return {e.Number("value") * unit, e.NotNegative("u") * unit, std::nullopt};
  }

 private:
  const Json& value_;
  std::string source_;
  std::string path_;
};

Json MakeJson(const core::Estimate& e, double unit = 1.0) {
  return {{"value", e.value / unit}, {"u", e.u / unit}};
}

LensRecord ReadLens(const Object& object, const Picture& picture) {
  LensRecord record;
  const std::string model = object.Word("model");
  if (model != "brown") {
    object.Fail("model", fmt::format("is '{}', must be 'brown'", model));
  }
  LensVector vector;
  for (int i = 0; i < kLensParameters; ++i) {
    vector[i] = object.Number(kLensNames[static_cast<std::size_t>(i)]);
  }
  record.lens = ToLens(vector);
  if (!IsInvertible(record.lens, picture.width_px, picture.height_px)) {
    object.Fail("k1",
                "and the others fold the picture back on itself: not a lens");
  }
  const Json& rows = object.Member("covariance");
  const char* square =
      "must be 9 rows of 9 numbers, symmetric, no variance "
      "below 0";
  if (!rows.is_array() || rows.size() != kLensParameters) {
    object.Fail("covariance", square);
  }
  for (int i = 0; i < kLensParameters; ++i) {
    const Json& row = rows[static_cast<std::size_t>(i)];
    if (!row.is_array() || row.size() != kLensParameters) {
      object.Fail("covariance", square);
    }
    for (int k = 0; k < kLensParameters; ++k) {
      const Json& number = row[static_cast<std::size_t>(k)];
      if (!number.is_number()) object.Fail("covariance", square);
      record.covariance(i, k) = number.get<double>();
    }
  }
  const LensCovariance& c = record.covariance;
  const LensVector unit = c.diagonal().unaryExpr(
      [](double v) { return v > 0.0 ? 1.0 / std::sqrt(v) : 0.0; });
  const LensCovariance scaled = unit.asDiagonal() * c * unit.asDiagonal();
  // 1e-6: rounding of a matrix whose correlations come near to 1.
  constexpr double kRounding = 1e-6;
  if (!c.allFinite() || c.diagonal().minCoeff() < 0.0 ||
      (scaled - scaled.transpose()).cwiseAbs().maxCoeff() > kRounding ||
      DecomposeLensCovariance(scaled).variances.minCoeff() < -kRounding) {
    object.Fail("covariance", square);
  }
  record.board = object.Word("board");
  record.rms_px = object.NotNegative("rms_px");
  record.coverage = object.NotNegative("coverage");
  const Json& views = object.Member("views");
  if (!views.is_array()) object.Fail("views", "must be a list");
  for (const Json& view : views) {
    if (!view.is_object() || !view.contains("name") ||
        !view.contains("rms_px") || !view["name"].is_string() ||
        !view["rms_px"].is_number()) {
      object.Fail("views", "must be a list of {name, rms_px}");
    }
    record.views.push_back(
        {view["name"].get<std::string>(), view["rms_px"].get<double>()});
  }
  return record;
}

Json MakeJson(const LensRecord& record) {
  Json json;
  json["model"] = "brown";
  const LensVector vector = ToVector(record.lens);
  for (int i = 0; i < kLensParameters; ++i) {
    json[kLensNames[static_cast<std::size_t>(i)]] = vector[i];
  }
  json["covariance_order"] = kLensNames;
  Json rows = Json::array();
  for (int i = 0; i < kLensParameters; ++i) {
    Json row = Json::array();
    for (int k = 0; k < kLensParameters; ++k) {
      row.push_back(record.covariance(i, k));
    }
    rows.push_back(row);
  }
  json["covariance"] = rows;
  json["board"] = record.board;
  json["rms_px"] = record.rms_px;
  json["coverage"] = record.coverage;
  json["views"] = Json::array();
  for (const LensRecord::View& view : record.views) {
    json["views"].push_back({{"name", view.name}, {"rms_px", view.rms_px}});
  }
  return json;
}

Picture ReadPicture(const Object& object) {
  Picture picture;
  picture.width_px = object.Whole("width_px", 1);
  picture.height_px = object.Whole("height_px", 1);
  if (object.Has("sensor_x_px") || object.Has("sensor_y_px")) {
    picture.corner = SensorCorner{object.Whole("sensor_x_px", 0),
                                  object.Whole("sensor_y_px", 0)};
  }
  return picture;
}

GroundRecord ReadGround(const Object& object) {
  GroundRecord ground;
  ground.p1 = {object.Number("x1_px"), object.Number("y1_px")};
  ground.p2 = {object.Number("x2_px"), object.Number("y2_px")};
  if (ground.p1 == ground.p2) {
    object.Fail("x2_px", "and y2_px: the two points coincide");
  }
  ground.u_point_px = object.NotNegative("u_point_px");
  if (object.Has("slope_deg")) {
    ground.slope_rad = object.Estimate("slope_deg", core::kDegree);
  }
  if (object.Has("yaw_deg")) {
    ground.yaw_rad = object.Estimate("yaw_deg", core::kDegree);
  }
  return ground;
}

std::string SizeText(const Picture& picture) {
  std::string text =
      fmt::format("{}x{} px", picture.width_px, picture.height_px);
  if (picture.corner) {
    text += fmt::format(" at {},{} of the sensor", picture.corner->x_px,
                        picture.corner->y_px);
  }
  return text;
}

}  // namespace

bool IsDate(std::string_view text) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return false;
  int numbers[3] = {0, 0, 0};
  // Places and lengths of year, month and day in YYYY-MM-DD.
  constexpr std::size_t kFirst[3] = {0, 5, 8};
  constexpr std::size_t kDigits[3] = {4, 2, 2};
  for (std::size_t part = 0; part < 3; ++part) {
    for (std::size_t i = 0; i < kDigits[part]; ++i) {
      const char c = text[kFirst[part] + i];
      if (c < '0' || c > '9') return false;
      numbers[part] = 10 * numbers[part] + (c - '0');
    }
  }
  return std::chrono::year_month_day(
             std::chrono::year(numbers[0]),
             std::chrono::month(static_cast<unsigned>(numbers[1])),
             std::chrono::day(static_cast<unsigned>(numbers[2])))
      .ok();
}

Calibration ParseCalibration(const std::string& text,
                             const std::string& source) {
  Json document;
  try {
    document = Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw core::InputError(fmt::format(
        "{}: is not JSON: trouble at byte {}; `touchdown calibrate` writes "
        "calibration files",
        source, error.byte));
  } catch (const Json::out_of_range&) {
    throw core::InputError(fmt::format(
        "{}: a number in it is too large; expected numbers up to 1e308",
        source));
  }
  const Object object(document, source, "");
  const std::string schema = object.Word("schema");
  if (schema != kSchema) {
    object.Fail("schema",
                fmt::format("is '{}', must be '{}'", schema, kSchema));
  }
  Calibration out;
  out.camera = object.Word("camera");
  out.date = object.Date("date");
  out.expires = object.Date("expires");
  out.picture = ReadPicture(object.Child("picture"));
  if (object.Has("lens")) {
    out.lens = ReadLens(object.Child("lens"), out.picture);
  }
  if (object.Has("scale")) {
    const Object scale = object.Child("scale");
    ScaleRecord record;
    record.px_per_m = scale.Estimate("px_per_m");
    if (!(record.px_per_m.value > 0.0)) {
      scale.Fail("px_per_m", "must be positive");
    }
    record.length_m = scale.Positive("length_mm") * core::kMillimetre;
    if (scale.Has("check_error_mm")) {
      record.check_error_m =
          scale.Estimate("check_error_mm", core::kMillimetre);
    }
    out.scale = record;
  }
  if (object.Has("ground")) out.ground = ReadGround(object.Child("ground"));
  return out;
}

Calibration ReadCalibration(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    throw core::InputError(
        fmt::format("{}: cannot be read; is it there, and may you read it?",
                    path.string()));
  }
  const std::string text(std::istreambuf_iterator<char>(in), {});
  return ParseCalibration(text, path.string());
}

std::string CalibrationText(const Calibration& c) {
  Json json;
  json["schema"] = kSchema;
  json["camera"] = c.camera;
  json["date"] = c.date;
  json["expires"] = c.expires;
  json["picture"] = {{"width_px", c.picture.width_px},
                     {"height_px", c.picture.height_px}};
  const auto& corner = c.picture.corner;
  json["picture"]["sensor_x_px"] = corner ? Json(corner->x_px) : Json(nullptr);
  json["picture"]["sensor_y_px"] = corner ? Json(corner->y_px) : Json(nullptr);
  json["lens"] = c.lens ? MakeJson(*c.lens) : Json(nullptr);
  json["scale"] = nullptr;
  if (c.scale) {
    json["scale"] = {{"px_per_m", MakeJson(c.scale->px_per_m)},
                     {"length_mm", c.scale->length_m / core::kMillimetre}};
    if (c.scale->check_error_m) {
      json["scale"]["check_error_mm"] =
          MakeJson(*c.scale->check_error_m, core::kMillimetre);
    }
  }
  json["ground"] = nullptr;
  if (c.ground) {
    const GroundRecord& g = *c.ground;
    json["ground"] = {{"x1_px", g.p1.x_px},
                      {"y1_px", g.p1.y_px},
                      {"x2_px", g.p2.x_px},
                      {"y2_px", g.p2.y_px},
                      {"u_point_px", g.u_point_px}};
    if (g.slope_rad) {
      json["ground"]["slope_deg"] = MakeJson(*g.slope_rad, core::kDegree);
    }
    if (g.yaw_rad) {
      json["ground"]["yaw_deg"] = MakeJson(*g.yaw_rad, core::kDegree);
    }
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void WriteCalibration(const std::filesystem::path& path,
                      const Calibration& calibration) {
  core::OutputFile file(path);
  file.Write(CalibrationText(calibration));
  file.Commit();
}

core::Expected<Calibration> AdaptToPicture(const Calibration& calibration,
                                           const Picture& picture) {
  const Picture& of = calibration.picture;
  const bool same_size =
      of.width_px == picture.width_px && of.height_px == picture.height_px;
  const bool places_known = of.corner && picture.corner;
  const auto refuse = [&](const char* why) {
    return core::AbsentBecause(fmt::format(
        "the calibration is of {} pictures, the recording has {}: {}",
        SizeText(of), SizeText(picture), why));
  };
  if (!places_known) {
    if (!same_size) {
      return refuse(
          "if it is a part of the calibrated picture, say where with --crop "
          "X,Y; else calibrate at this resolution");
    }
    return calibration;
  }
  const std::int32_t dx = picture.corner->x_px - of.corner->x_px;
  const std::int32_t dy = picture.corner->y_px - of.corner->y_px;
  if (dx < 0 || dy < 0 || dx + picture.width_px > of.width_px ||
      dy + picture.height_px > of.height_px) {
    return refuse(
        "it reaches beyond what was calibrated; calibrate with the whole "
        "sensor");
  }
  Calibration out = calibration;
  out.picture = picture;
  if (out.lens) out.lens->lens = Cropped(out.lens->lens, dx, dy);
  if (out.ground) {
    for (core::PixelPoint* p : {&out.ground->p1, &out.ground->p2}) {
      p->x_px -= dx;
      p->y_px -= dy;
    }
  }
  return out;
}

std::optional<std::string> AgeWarning(const Calibration& calibration,
                                      std::string_view today) {
  // Days written so are in the order of their letters.
  if (calibration.expires < today) {
    return fmt::format("the calibration of {} expired on {}; calibrate again",
                       calibration.date, calibration.expires);
  }
  if (calibration.date > today) {
    return fmt::format(
        "the calibration is dated {}, later than today ({}); check the clocks",
        calibration.date, today);
  }
  return std::nullopt;
}

}  // namespace touchdown::calib
