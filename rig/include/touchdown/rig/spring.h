// The ejector's parallel-double spring.
#pragma once

namespace touchdown::rig {

// Which diameter of the coil a number is. The paper prints D_2 and calls it
// "outer"; the formula needs the mean.
enum class CoilDiameter { kMean, kOuter, kInner };

}  // namespace touchdown::rig
