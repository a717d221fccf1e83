// What a person states of a trial, as it is typed: at the command line and on
// the review page.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "touchdown/core/body.h"
#include "touchdown/core/conditions.h"
#include "touchdown/core/trial.h"
#include "touchdown/db/store.h"

namespace touchdown::pipeline {

// A field that cannot be taken as it was typed. what() is
// "--state is 'hop', must be ...".
class FieldError : public std::invalid_argument {
 public:
  // `field` is named as the flag is, without dashes; `problem` goes on from it.
  FieldError(const std::string& field, const std::string& problem)
      : std::invalid_argument("--" + field + " " + problem),
        field_(field),
        problem_(problem) {}
  const std::string& field() const { return field_; }
  const std::string& problem() const { return problem_; }

 private:
  std::string field_;
  std::string problem_;
};

inline constexpr const char* kStateWords =
    "bounce, slide, roll-slide, roll, stick, stays-down or undecided";

// Empty fields state nothing.
struct Statement {
  std::optional<double> angle_deg;
  std::optional<double> angle_u_deg;
  std::string angle_kind;
  std::string state;
  std::string corner;
  std::optional<double> set_angle_deg;
  std::optional<double> set_speed_mps;
  std::string note;
  std::optional<core::Conditions> conditions;  // all of them, where stated
};

// Puts what was stated into `trial`; the rest stays as it is. Throws
// FieldError.
void Apply(const Statement& statement, core::Trial& trial);

// What revision `number` stated, an analysis that was proposed as well, as a
// correction of `seen`. Throws FieldError, naming `field`, where there is none.
core::Trial Restated(const std::string& field,
                     const std::vector<db::Revision>& history,
                     const core::Trial& seen, std::int64_t number);

// A trial by hand.
struct ManualEntry {
  std::string campaign;            // empty: none; then there must be a body
  std::optional<core::Body> body;  // nothing: the campaign's
  Statement statement;             // with a state
  std::string by;
};

// Logs it as a new trial of origin `manual`. A store is made only for a trial
// that refers to no campaign and no entry of the register, and only for what
// has been found right. Throws FieldError, std::invalid_argument,
// core::StoreError.
db::Logged LogByHand(const std::filesystem::path& store,
                     const ManualEntry& entry);

}  // namespace touchdown::pipeline
