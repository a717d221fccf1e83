// These tests start themselves as readers, as the program does.
#include <gtest/gtest.h>

#include "touchdown/vision/footage/clip_apart.h"

int main(int argc, char** argv) {
  if (const auto status = touchdown::vision::ServeAsReader(argc, argv)) {
    return *status;
  }
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
