// The head of a request to the review page, as anybody on the machine may send
// it.
#include <string>

#include "app/review/http.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;
  const std::string_view bytes = fuzz::Text(data, size);
  const auto length = review::HeadLength(bytes);
  if (!length) return 0;
  fuzz::Require(*length <= size, "a head is within its bytes");
  const auto head = review::ReadHead(bytes.substr(0, *length));
  if (!head) {
    fuzz::Require(head.error().status >= 400, "a refusal has its status");
    return 0;
  }
  fuzz::Require(head->request.path.size() <= size,
                "decoding makes nothing longer");
  fuzz::Require(head->request.body.empty(), "a head has no body");
  return 0;
}
