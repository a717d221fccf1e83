// A strip of photographs as SVG elements inside the page. The picture is an
// image element with the bytes in its address, and all lines are drawn in px of
// the recording, so that no coordinate is converted; the viewBox cuts out the
// piece.
#include "app/report/contact_strip.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/text/text.h"

namespace touchdown::report {
namespace {

// Colours that colour-blind eyes tell apart (Okabe and Ito), each line with its
// own dashes and a dark rim, so that neither colour nor background matters.
constexpr const char* kOutline = "#F0E442";
constexpr const char* kGround = "#56B4E9";
constexpr const char* kBefore = "#00D89A";
constexpr const char* kAfter = "#F0A0CC";

// Points in the form of SVG, to a hundredth of a px: "12.50,80.25 13.00,81.00".
std::string Points(const std::vector<core::PixelPoint>& points) {
  std::string out;
  for (const core::PixelPoint& p : points) {
    out +=
        fmt::format("{}{:.2f},{:.2f}", out.empty() ? "" : " ", p.x_px, p.y_px);
  }
  return out;
}

// A coloured line over a wider dark one, which is its rim. `element` is
// polyline or polygon, `dashes` an SVG dash array or "". Empty below two
// points. Widths are in px of the screen, whatever the scale of the picture.
std::string RimmedLine(const char* element,
                       const std::vector<core::PixelPoint>& points,
                       const char* colour, const char* dashes) {
  if (points.size() < 2) return "";
  const std::string at = Points(points);
  std::string out;
  const auto stroke = [&](const char* with, double width) {
    out += fmt::format(
        "<{} points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" "
        "vector-effect=\"non-scaling-stroke\"{}/>",
        element, at, with, width,
        *dashes == '\0' ? "" : fmt::format(" stroke-dasharray=\"{}\"", dashes));
  };
  stroke("#101418", 3.2);
  stroke(colour, 1.6);
  return out;
}

// The greatest of 1, 2 or 5 times a power of ten that is at most `most` (> 0).
double Round(double most) {
  const double ten = std::pow(10.0, std::floor(std::log10(most)));
  for (const double step : {5.0, 2.0}) {
    if (step * ten <= most) return step * ten;
  }
  return ten;
}

// A bar of a round length in the lower left corner, with its length in mm
// beside it, or in px where there is no scale.
std::string ScaleBar(const core::PixelRect& piece,
                     const std::optional<double>& px_per_m) {
  constexpr double kShare = 0.35;  // of the width, at most
  // A unit of the bar is a mm, or a px without a scale.
  const double px_per_unit = px_per_m ? *px_per_m * 1e-3 : 1.0;
  const double units = Round(kShare * piece.width / px_per_unit);
  const double length = units * px_per_unit;
  // Sizes are shares of the piece: the strip is shown at one width, however
  // many px the piece has.
  const double text = piece.width / 17.0;
  const double x = piece.x + 0.05 * piece.width;
  const double y = piece.y + piece.height - 0.07 * piece.height;
  return RimmedLine("polyline", {{x, y}, {x + length, y}}, "#ffffff", "") +
         fmt::format(
             "<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:.2f}\" "
             "fill=\"#ffffff\" stroke=\"#101418\" stroke-width=\"{:.2f}\" "
             "paint-order=\"stroke\">{:g} {}</text>",
             x + length + 0.5 * text, y + 0.35 * text, text, text / 5, units,
             px_per_m ? "mm" : "px");
}

// A white cross whose arms reach `reach` px to each side.
std::string Cross(core::PixelPoint at, double reach) {
  return RimmedLine("polyline",
                    {{at.x_px - reach, at.y_px - reach},
                     {at.x_px + reach, at.y_px + reach}},
                    "#ffffff", "") +
         RimmedLine("polyline",
                    {{at.x_px - reach, at.y_px + reach},
                     {at.x_px + reach, at.y_px - reach}},
                    "#ffffff", "");
}

// One photograph with what was measured in it, as an SVG element. It is hidden
// from screen readers, which read the alternative text of the whole strip.
std::string DrawPicture(const StripPicture& picture, const ContactStrip& strip,
                        bool with_scale) {
  const core::PixelRect& piece = picture.piece;
  // Pixel centres are at integers: a picture begins half a pixel before.
  std::string out = fmt::format(
      "<svg viewBox=\"{0} {1} {2} {3}\" aria-hidden=\"true\"><image x=\"{0}\" "
      "y=\"{1}\" width=\"{2}\" height=\"{3}\" preserveAspectRatio=\"none\" "
      "style=\"image-rendering:pixelated\" "
      "href=\"data:image/png;base64,{4}\"/>",
      piece.x - 0.5, piece.y - 0.5, piece.width, piece.height,
      Base64(picture.png));
  // The outline lies over the flights, and the contact point over all.
  out += RimmedLine("polyline", picture.ground, kGround, "6 3");
  out += RimmedLine("polyline", picture.before, kBefore, "1.5 3");
  out += RimmedLine("polyline", picture.after, kAfter, "7 2 1.5 2");
  out += RimmedLine("polygon", picture.outline, kOutline, "");
  if (picture.touching) {
    out += Cross(*picture.touching, std::max(1.5, piece.width / 70.0));
  }
  if (with_scale) out += ScaleBar(piece, strip.px_per_m);
  return out + "</svg>";
}

}  // namespace

const char* const kStripLegend =
    "Drawn into the pictures: the outline as it was fitted (yellow, solid), "
    "the "
    "ground line (blue, dashed), the centre's fitted flight before touchdown "
    "(green, dotted) and after it (pink, dash-dotted), the contact point "
    "(cross), a scale bar. Levels of grey are stretched.";

Strip DrawStrip(const ContactStrip& strip, const std::string& caption) {
  Strip out;
  out.caption = caption;
  for (const StripPicture& picture : strip.pictures) {
    // The scale bar stands in the first picture: all have one scale.
    out.panels.push_back(
        {DrawPicture(picture, strip, out.panels.empty()), picture.label});
    out.alt += (out.alt.empty() ? "Pictures: " : "; ") + picture.label;
  }
  out.alt += ". With outline, ground line and flights drawn in.";
  return out;
}

}  // namespace touchdown::report
