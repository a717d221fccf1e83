#include "vision/src/contact/impacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace touchdown::vision {
namespace {

core::ContactRecord With(std::optional<core::Estimate> e, int unresolved = 0) {
  core::ContactRecord record;
  record.motion.restitution = core::AbsentBecause("not resolved");
  if (e) record.motion.restitution = *e;
  record.motion.unresolved_impacts = unresolved;
  return record;
}

// A first contact without a release that was seen, two impacts between two
// frames, two that were resolved, and the last, of which the film shows no
// more: by hand, w = 1/0.01^2 and 1/0.02^2.
TEST(PoolRestitution, OfWhatWasResolved) {
  ContactResult contacts;
  contacts.first = With({});
  contacts.later = {With({}, 2), With(core::Estimate{0.60, 0.01, {}}),
                    With(core::Estimate{0.61, 0.02, {}}), With({})};
  const RestitutionOfImpacts e = PoolRestitution(contacts);
  ASSERT_TRUE(e.value);
  EXPECT_NEAR(e.value->value, 0.602, 1e-12);
  EXPECT_NEAR(e.value->u, 0.01 / std::sqrt(1.25), 1e-12);
  EXPECT_EQ(e.resolved, 2);
  EXPECT_EQ(e.unresolved, 3);
}

// 0.6 and 0.7, each to 0.01: chi^2 = 50 widens u by sqrt(50).
TEST(PoolRestitution, ScatterWidensU) {
  ContactResult contacts;
  contacts.first = With(core::Estimate{0.60, 0.01, {}});
  contacts.later = {With(core::Estimate{0.70, 0.01, {}})};
  const RestitutionOfImpacts e = PoolRestitution(contacts);
  ASSERT_TRUE(e.value);
  EXPECT_NEAR(e.value->value, 0.65, 1e-12);
  EXPECT_NEAR(e.value->u, 0.01 * std::sqrt(0.5) * std::sqrt(50.0), 1e-9);
  EXPECT_EQ(e.unresolved, 0);
}

TEST(PoolRestitution, NothingResolved) {
  ContactResult contacts;
  contacts.first = With({}, 2);
  EXPECT_FALSE(PoolRestitution(contacts).value);
  EXPECT_EQ(PoolRestitution(contacts).unresolved, 2);
}

}  // namespace
}  // namespace touchdown::vision
