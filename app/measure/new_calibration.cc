#include "app/measure/new_calibration.h"

#include "app/text/dates.h"

namespace touchdown::pipeline {

calib::Calibration NewCalibration(const std::string& camera,
                                  const calib::Picture& picture,
                                  const std::string& date, int valid_days) {
  calib::Calibration out;
  out.camera = camera;
  out.date = date.empty() ? Today() : date;
  out.expires = AddDays("--date", out.date, valid_days);
  out.picture = picture;
  // Files that do not say where the picture lies show the whole sensor.
  if (!out.picture.corner) out.picture.corner = calib::SensorCorner{};
  return out;
}

}  // namespace touchdown::pipeline
