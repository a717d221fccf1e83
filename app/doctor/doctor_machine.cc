#include "app/doctor/doctor_machine.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <thread>

#include "app/text/scratch_folder.h"
#include "app/text/version.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/frame.h"
#include "touchdown/vision/footage/clip_apart.h"
#include "touchdown/vision/footage/image_file.h"
#include "touchdown/vision/footage/video_decoders.h"

namespace touchdown::pipeline {
namespace {

namespace fs = std::filesystem;

// Says which program this is: its version and the commit it was built from.
Finding ProgramFinding() {
  return {"program",
          Health::kGood,
          fmt::format("{} ({})", Version(), Commit()),
          {}};
}

// Reads the name of the distribution from the line
// PRETTY_NAME="Debian GNU/Linux 12 (bookworm)"
std::string Distribution() {
  std::ifstream in("/etc/os-release");
  constexpr std::string_view kKey = "PRETTY_NAME=";
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(kKey)) continue;
    line.erase(0, kKey.size());
    std::erase(line, '"');
    return line;
  }
  return "unknown distribution";
}

// Says what the machine is: distribution, kernel, architecture, cores, and its
// memory in GiB (1024^3 bytes).
Finding SystemFinding() {
  utsname name{};
  uname(&name);
  constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;
  const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
                        static_cast<double>(sysconf(_SC_PAGESIZE));
  return {"system",
          Health::kGood,
          fmt::format("{}, {} {} {}, {} cores, {:.1f} GiB of memory",
                      Distribution(), name.sysname, name.release, name.machine,
                      std::thread::hardware_concurrency(), memory / kGiB),
          {}};
}

// What is loaded now of which the name begins so, by its full name:
// "libtiff.so.6.0.0".
std::string Loaded(std::string_view beginning) {
  std::vector<std::string> names;
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* data) {
        // The program itself has an empty name, and the kernel's vdso no path:
        // both are passed over.
        std::error_code none;
        const fs::path file = fs::canonical(info->dlpi_name, none);
        if (!none && *info->dlpi_name == '/') {
          static_cast<std::vector<std::string>*>(data)->push_back(
              file.filename().string());
        }
        return 0;
      },
      &names);
  std::erase_if(names, [&](const std::string& name) {
    return !name.starts_with(beginning);
  });
  return fmt::format("{}", fmt::join(names, " "));
}

// Before a video is opened: libav brings a hundred more.
Finding LibrariesFinding() {
  return {"libraries", Health::kGood, Loaded("lib"), {}};
}

// Loads libav and says which video codecs it decodes. A codec that is not there
// is a note: few labs have recordings of every kind. Without libav no video can
// be read at all, which is trouble.
Finding VideoFinding() {
  try {
    std::string there;
    std::string missing;
    for (const vision::VideoDecoder& codec : vision::VideoDecoders()) {
      (codec.is_there ? there : missing) += " " + codec.name;
    }
    Finding video{"video",
                  Health::kGood,
                  fmt::format("{}: reads{}", Loaded("libav"), there),
                  {}};
    if (!missing.empty()) {
      video.health = Health::kNote;
      video.text += "; not" + missing;
      video.advice = "recordings of these kinds are to be converted";
    }
    return video;
  } catch (const core::InputError& error) {
    return {"video", Health::kTrouble, error.what(),
            "without it only raw recordings and folders of images are read"};
  }
}

// A recording of one picture of our own is read as a stranger's would be.
// Recordings are decoded in a process of their own, which may read nothing but
// the recording and reach no network. This tries it and says what the kernel
// granted.
Finding ReaderFinding() {
  const auto trouble = [](const std::string& what) {
    return Finding{"reader", Health::kTrouble, what,
                   "no video and no picture can be read"};
  };
  try {
    const ScratchFolder folder;
    // The picture is black and of 16 x 16 px: what is tried is the way to it,
    // not its content. The scratch folder removes it at the end.
    constexpr std::int32_t kSide_px = 16;
    std::array<std::byte, kSide_px * kSide_px> pixels{};
    core::Frame frame;
    frame.data = pixels.data();
    frame.width_px = frame.height_px = kSide_px;
    frame.stride_bytes = kSide_px;
    frame.bit_depth = 8;
    vision::WritePng(folder.path() / "0.png", frame);
    vision::Confinement granted;
    vision::ClipOptions options;
    // A folder of images tells no frame rate, and one is asked for.
    options.fps = 1.0;
    vision::OpenClipApart(folder.path(), options, {}, &granted)->Read(0);
    const bool all =
        granted.is_apart && granted.seccomp.empty() && granted.landlock.empty();
    const auto word = [](const std::string& refused) {
      return refused.empty() ? "in force" : "refused (" + refused + ")";
    };
    return {"reader", all ? Health::kGood : Health::kNote,
            granted.is_apart
                ? fmt::format("a process of its own; seccomp {}, Landlock {}",
                              word(granted.seccomp), word(granted.landlock))
                : "in this process",
            all ? ""
                : "recordings are read all the same; take those of strangers "
                  "to a machine whose kernel has both"};
  } catch (const std::exception& error) {
    return trouble(error.what());
  }
}

// Says whether a folder of PATH has the program and this user may run it.
bool IsOnPath(std::string_view program) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

// Looks for a program that this one calls. `without` says how bad its absence
// is, `what_for` what then does not work, `package` which Debian package has
// it.
Finding ToolFinding(std::string_view program, std::string_view package,
                    Health without, std::string_view what_for) {
  if (IsOnPath(program)) {
    return {std::string(program), Health::kGood, "is there", {}};
  }
  return {std::string(program), without,
          fmt::format("is not there: {}", what_for),
          fmt::format("install the package {}", package)};
}

// The library is loaded when a lens is calibrated and not before, so that every
// other command starts without it; whether it is there shows only when it is
// asked for.
Finding LapackFinding() {
  if (void* const library = dlopen("liblapack.so.3", RTLD_LAZY)) {
    dlclose(library);
    return {"lapack", Health::kGood, "is there", {}};
  }
  return {"lapack", Health::kNote, "is not there: no lens can be calibrated",
          "install the package liblapack3"};
}

}  // namespace

std::vector<Finding> ExamineMachine() {
  // The order matters for the libraries: they are listed before VideoFinding
  // loads libav.
  std::vector<Finding> findings{ProgramFinding(), SystemFinding(),
                                LibrariesFinding(), VideoFinding(),
                                ReaderFinding()};
  findings.push_back(LapackFinding());
  findings.push_back(ToolFinding("gnuplot", "gnuplot-nox", Health::kTrouble,
                                 "no report has plots"));
  findings.push_back(
      ToolFinding("xdg-open", "xdg-utils", Health::kNote,
                  "`review` prints its address and opens no browser"));
  return findings;
}

}  // namespace touchdown::pipeline
