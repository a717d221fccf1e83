// A planted breach for constants.cmake: the second constant has no comment.
namespace touchdown::vision {
namespace {

constexpr double kExplained_px = 1.0;  // px

constexpr double kPlanted_px = 2.0;

}  // namespace
}  // namespace touchdown::vision
