#include "app/measure/board_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/clip_apart.h"

namespace touchdown::pipeline {

namespace fs = std::filesystem;

StillPicture ReadPicture(const fs::path& path, std::int64_t frame) {
  StillPicture picture;
  if (!fs::is_directory(path) && vision::IsImageName(path) &&
      !vision::IsTiffStack(path)) {
    picture.image = vision::ReadImageApart(path);
    return picture;
  }
  vision::ClipOptions options;
  options.fps = 1.0;  // time is not looked at
  const auto clip = vision::OpenClipApart(path, options);
  if (frame < 0 || frame >= clip->info().frames) {
    throw std::invalid_argument(
        fmt::format("--frame is {}, must be within 0 .. {} of {}", frame,
                    clip->info().frames - 1, path.string()));
  }
  const core::Frame view = clip->Read(frame);
  vision::Image& image = picture.image;
  image.width_px = view.width_px;
  image.height_px = view.height_px;
  image.bit_depth = view.bit_depth;
  const std::size_t row_bytes =
      static_cast<std::size_t>(view.width_px) * (view.is_16_bit() ? 2u : 1u);
  image.pixels.resize(row_bytes * static_cast<std::size_t>(view.height_px));
  for (std::int32_t y = 0; y < view.height_px; ++y) {
    std::memcpy(image.pixels.data() + static_cast<std::size_t>(y) * row_bytes,
                view.data + y * view.stride_bytes, row_bytes);
  }
  if (const auto& origin = clip->info().sensor_origin) {
    picture.corner = calib::SensorCorner{origin->x_px, origin->y_px};
  }
  return picture;
}

std::vector<fs::path> ListPictures(const fs::path& folder) {
  std::vector<fs::path> inside;
  std::error_code trouble;
  fs::directory_iterator entry(folder, trouble);
  for (; !trouble && entry != fs::directory_iterator();
       entry.increment(trouble)) {
    if (vision::IsImageName(entry->path())) inside.push_back(entry->path());
  }
  if (trouble) {
    throw core::InputError(
        fmt::format("{}: {}", folder.string(), trouble.message()));
  }
  std::sort(inside.begin(), inside.end());
  return inside;
}

BoardPictures FindBoards(std::span<const fs::path> images,
                         const calib::Board& board,
                         const std::optional<calib::SensorCorner>& corner,
                         const std::function<void(double)>& progress) {
  BoardPictures found;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const StillPicture still = ReadPicture(images[i], 0);
    const calib::Picture picture{still.image.width_px, still.image.height_px,
                                 corner ? corner : still.corner};
    if (i == 0) found.picture = picture;
    if (picture.width_px != found.picture.width_px ||
        picture.height_px != found.picture.height_px) {
      throw core::InputError(fmt::format(
          "{}: has {}x{} px, {} has {}x{}; all pictures must be of one camera "
          "at one resolution",
          images[i].string(), picture.width_px, picture.height_px,
          images[0].string(), found.picture.width_px, found.picture.height_px));
    }
    auto points = calib::FindBoard(still.image.View(), board);
    const std::string name = images[i].filename().string();
    if (points) {
      found.views.push_back({name, *std::move(points)});
    } else {
      found.without.push_back(name);
    }
    if (progress) {
      progress(static_cast<double>(i + 1) / static_cast<double>(images.size()));
    }
  }
  return found;
}

calib::LensCalibration CalibrateBoardLens(const BoardPictures& pictures,
                                          const calib::Board& board) {
  const auto lens =
      calib::CalibrateLens(pictures.views, board, pictures.picture.width_px,
                           pictures.picture.height_px);
  if (lens) return *lens;
  std::string reason = lens.error().reason;
  if (!pictures.without.empty()) {
    reason += fmt::format(" (no whole {} in {} of {} pictures, {} first)",
                          calib::Text(board), pictures.without.size(),
                          pictures.without.size() + pictures.views.size(),
                          pictures.without.front());
  }
  throw core::InputError("calibrate lens: " + reason);
}

calib::LensRecord MakeLensRecord(const calib::LensCalibration& lens,
                                 const calib::Board& board) {
  calib::LensRecord record;
  record.lens = lens.lens;
  record.covariance = lens.covariance;
  record.board = calib::Text(board);
  record.rms_px = lens.rms_px;
  record.coverage = lens.coverage;
  for (const calib::ViewResult& view : lens.views) {
    record.views.push_back({view.name, view.rms_px});
  }
  return record;
}

}  // namespace touchdown::pipeline
