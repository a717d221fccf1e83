// What a person may have meant who typed a name that there is not.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace touchdown::core {

// The candidate that is off by at most a third of the word's letters (changed,
// added or left out), the nearest one; empty where there is none.
std::string Nearest(std::string_view word,
                    std::span<const std::string> candidates);

// "did you mean 'asphalt'?", or `otherwise` where nothing is near.
std::string DidYouMean(std::string_view word,
                       std::span<const std::string> candidates,
                       std::string_view otherwise);

}  // namespace touchdown::core
