// A planted breach: the other Planted is in again.h.
namespace touchdown::analysis {
struct Planted {
  int one = 1;
};
}  // namespace touchdown::analysis
