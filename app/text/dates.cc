#include "app/text/dates.h"

#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <stdexcept>

#include "touchdown/calib/calibration_file.h"

namespace touchdown::pipeline {

std::string Today() {
  // The day on the laboratory's clock, not in UTC: people compare it with dates
  // that they wrote themselves.
  const std::time_t now =
      std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm local{};
  localtime_r(&now, &local);
  return fmt::format("{:04}-{:02}-{:02}", local.tm_year + 1900,
                     local.tm_mon + 1, local.tm_mday);
}

std::string AddDays(const std::string& flag, const std::string& date,
                    int days) {
  // The same rule as for the dates in calibration files.
  if (!calib::IsDate(date)) {
    throw std::invalid_argument(
        fmt::format("{} is '{}', must be a day as in 2026-11-21", flag, date));
  }
  // IsDate() has seen the form 2026-11-21: year from 0, month from 5, day from
  // 8.
  const auto part = [&](std::size_t from, std::size_t count) {
    return std::stoi(date.substr(from, count));
  };
  // Counting in days since 1970 carries over the ends of months and leap years.
  const std::chrono::sys_days day(std::chrono::year_month_day(
      std::chrono::year(part(0, 4)),
      std::chrono::month(static_cast<unsigned>(part(5, 2))),
      std::chrono::day(static_cast<unsigned>(part(8, 2)))));
  const std::chrono::year_month_day after(day + std::chrono::days(days));
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(after.year()),
                     static_cast<unsigned>(after.month()),
                     static_cast<unsigned>(after.day()));
}

}  // namespace touchdown::pipeline
