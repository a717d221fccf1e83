// Detections linked over time: candidates for the body's path.
#pragma once

#include <cstdint>
#include <vector>

#include "detection/detect.h"

namespace touchdown::vision {

struct Link {
  std::int64_t frame = 0;
  double time_s = 0.0;
  Blob blob;
};

// One thing that was seen in frame after frame.
struct Chain {
  std::vector<Link> links;

  double Area() const;      // median, px^2
  double Contrast() const;  // median, DN, signed
  double Extent() const;    // largest distance from the first position, px
  double Strength() const;  // sum of area times squared contrast

  // Whether most of its links lie on flights: parabolas that open downward,
  // higher than half the body's size.
  bool Falls() const;
};

struct LinkOptions {
  // A chain ends when it was not seen for so many frames: an occlusion of the
  // body by a post of the rig passes, a new object is not joined to an old one.
  int most_missing = 5;

  // Of more chains only the strongest are joined and ranked, which costs the
  // square of their number. 2000: a few hundredths of a second; a clip of one
  // body has some ten, busy everyday footage some hundred.
  std::size_t most_chains = 2000;
};

// Adds the blobs of the next frame to the chains: each goes to the chain whose
// prediction (constant velocity) is nearest, within reach and alike, or starts
// one.
class ChainBuilder {
 public:
  explicit ChainBuilder(const LinkOptions& options = {}) : options_(options) {}
  void Add(std::int64_t frame, double time_s, const std::vector<Blob>& blobs);

  // All chains, those of one body that were interrupted joined, ordered by how
  // likely each is the body (size, contrast, length of stay, fall): best first.
  // Things that do not move are left out.
  std::vector<Chain> Finish();

  // How many of them most_chains left out.
  std::size_t left_out() const { return left_out_; }

 private:
  LinkOptions options_;
  std::vector<Chain> open_;
  std::vector<Chain> closed_;
  std::size_t left_out_ = 0;
};

// True if the two keep their distance while they move: parts of one body (or a
// body and the shadow beside it).
bool MoveAsOne(const Chain& a, const Chain& b);

// If `other` is as strong as `best` and moves as one with it, the length of the
// two together, px; else 0.
double LengthTogether(const Chain& best, const Chain& other);

// True if `other` is a second body beside `best`: seen at the same time, alike
// in size and contrast, and moving. (A shadow has less contrast.)
bool IsAnotherBody(const Chain& best, const Chain& other);

}  // namespace touchdown::vision
