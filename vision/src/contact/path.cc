#include "touchdown/vision/contact/path.h"

namespace touchdown::vision {

std::string_view Name(StretchKind kind) {
  switch (kind) {
    case StretchKind::kFlight:
      return "flight";
    case StretchKind::kSupported:
      return "supported";
    case StretchKind::kContact:
      return "contact";
    case StretchKind::kOther:
      break;
  }
  return "other";
}

}  // namespace touchdown::vision
