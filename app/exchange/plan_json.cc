// One line of an export, schema touchdown.plan/1 (here on three lines):
//   {"schema":"touchdown.plan/1","id":UUID,"campaign":"asphalt","kind":"plan",
//    "design":"ascending 2 deg steps","stopping_rule":"after 40 trials",
//    "error_rates":"","trials":0,"author":...,"reason":"","at_utc":...}
#include "app/exchange/plan_json.h"

#include "app/text/json_fields.h"

namespace touchdown::report {

// `trials` is a number of trials: how many the campaign had when the event
// happened, which tells whether the plan was made before the first.
std::string PlanEventJson(const db::PlanEvent& event) {
  const Json json = {{"schema", kPlanSchema},
                     {"id", TextJson(event.id)},
                     {"campaign", TextJson(event.campaign)},
                     {"kind", Name(event.kind)},
                     {"design", TextJson(event.plan.design)},
                     {"stopping_rule", TextJson(event.plan.stopping_rule)},
                     {"error_rates", TextJson(event.plan.error_rates)},
                     {"trials", event.trials},
                     {"author", TextJson(event.author)},
                     {"reason", TextJson(event.reason)},
                     {"at_utc", TextJson(event.at_utc)}};
  return json.dump();
}

// Every field must be there. A look has an empty plan, written as three empty
// texts.
db::PlanEvent PlanEventFromJson(std::string_view line) {
  const Json json = ParsedLine(line, kPlanSchema);
  db::PlanEvent event;
  event.id = ReadTextField(json, "id");
  event.campaign = ReadTextField(json, "campaign");
  event.kind = ReadWord(json, "kind", db::ParsePlanEventKind);
  event.plan.design = ReadTextField(json, "design");
  event.plan.stopping_rule = ReadTextField(json, "stopping_rule");
  event.plan.error_rates = ReadTextField(json, "error_rates");
  event.trials = ReadInteger(json, "trials");
  event.author = ReadTextField(json, "author");
  event.reason = ReadTextField(json, "reason");
  event.at_utc = ReadTextField(json, "at_utc");
  return event;
}

}  // namespace touchdown::report
