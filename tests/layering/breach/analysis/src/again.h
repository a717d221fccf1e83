// A planted breach: the other Planted is in twice.h.
namespace touchdown::analysis {
struct Planted {
  int two = 2;
};
}  // namespace touchdown::analysis
