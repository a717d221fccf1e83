// A recording as the commands open it: foreign ones in a process of their own.
#pragma once

#include <filesystem>
#include <memory>

#include "touchdown/vision/footage/clip.h"

namespace touchdown::pipeline {

// vision::OpenClipApart; the journal says where it is read, and what the kernel
// did not grant.
std::unique_ptr<vision::Clip> OpenRecording(
    const std::filesystem::path& path, const vision::ClipOptions& options = {});

}  // namespace touchdown::pipeline
