#include "train/contrast/data_contrast.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "runtime/error.h"
#include "train/contrast/warp.h"

namespace vkopple {
namespace {

constexpr double kMostWarped = 0.99;  // a warped image's largest share of a prediction (docs/model.md §5)
/// Loss a pixel below which nothing moved: what the projection's 1e-5 makes of pixels that stay where they are.
/// Colours rounded to 8 bits have more.
constexpr double kRounding = 1e-6;

void require_known(const KnownTriplet& t, std::size_t area) {
  if (t.image.size() != 3 * area || t.next.size() != 3 * area || t.depth.size() != area ||
      t.label.size() != area)
    throw Error(fmt::format("a triplet's pictures or truth don't have the {} pixels of the lens", area));
  const std::uint32_t largest = *std::max_element(t.label.begin(), t.label.end());
  if (largest >= t.motion.size())
    throw Error(fmt::format("label {} of a triplet has no motion; there are {}", largest, t.motion.size()));
}

/// Frame 2 moved to frame 3.
WarpedImage warp(const Lens& lens, double beta, const KnownTriplet& t, std::span<const float> depth,
                 bool objects_move) {
  std::vector<Vec3> points = back_project_pixels(lens, depth);
  for (std::size_t p = 0; p < points.size(); ++p)
    points[p] = map_point(t.motion[objects_move ? t.label[p] : 0], points[p]);
  return splat_pixels(lens, beta, t.image, points);
}

double share_of(const WarpedImage& warped, std::size_t pixel) { return std::min(warped.total[pixel], 1.0); }

double square(double x) { return x * x; }

double filled_loss(const KnownTriplet& t, const WarpedImage& warped) {
  const std::size_t area = warped.total.size();
  double sum = 0;
  for (std::size_t i = 0; i < t.next.size(); ++i) {
    const double share = kMostWarped * share_of(warped, i % area);
    sum += square(share * warped.colour[i] + (1 - share) * double{t.image[i]} - double{t.next[i]});
  }
  return sum;
}

double weighed_loss(const KnownTriplet& t, const WarpedImage& warped, const std::vector<double>& weight) {
  double sum = 0;
  for (std::size_t i = 0; i < t.next.size(); ++i)
    sum += weight[i % weight.size()] * square(warped.colour[i] - double{t.next[i]});
  return sum;
}

}  // namespace

void DataContrast::add(const KnownTriplet& triplet) {
  require_known(triplet, lens_.pixels());
  const std::size_t area = lens_.pixels();
  const double mean_depth =
      std::accumulate(triplet.depth.begin(), triplet.depth.end(), 0.0) / static_cast<double>(area);
  const std::vector<float> constant(area, static_cast<float>(mean_depth));
  const WarpedImage ideal = warp(lens_, beta_, triplet, triplet.depth, true);
  const WarpedImage flat = warp(lens_, beta_, triplet, constant, true);
  const WarpedImage still = warp(lens_, beta_, triplet, triplet.depth, false);
  std::vector<double> all_land(area);
  for (std::size_t p = 0; p < area; ++p)
    all_land[p] = std::min({share_of(ideal, p), share_of(flat, p), share_of(still, p)});

  ++triplets_;
  whole_.ideal += filled_loss(triplet, ideal);
  whole_.flat += filled_loss(triplet, flat);
  whole_.still += filled_loss(triplet, still);
  landed_.ideal += weighed_loss(triplet, ideal, all_land);
  landed_.flat += weighed_loss(triplet, flat, all_land);
  landed_.still += weighed_loss(triplet, still, all_land);
  landed_pixels_ += std::accumulate(all_land.begin(), all_land.end(), 0.0);
}

PredictionLosses DataContrast::mean(const PredictionLosses& sums) const {
  if (triplets_ == 0) return {};
  const auto count = static_cast<double>(triplets_);
  return {sums.ideal / count, sums.flat / count, sums.still / count};
}

double DataContrast::landed_share() const {
  if (triplets_ == 0) return 0;
  return landed_pixels_ / static_cast<double>(triplets_) / static_cast<double>(lens_.pixels());
}

std::optional<double> DataContrast::ratio(double loss, double ideal) const {
  if (ideal <= kRounding * static_cast<double>(lens_.pixels())) return std::nullopt;
  return loss / ideal;
}

Json DataContrast::to_json() const {
  const auto told = [this](const PredictionLosses& losses) {
    const auto value = [&](double loss) {
      const auto r = ratio(loss, losses.ideal);
      return r ? Json(*r) : Json(nullptr);
    };
    return Json{{"losses", {{"ideal", losses.ideal}, {"flat", losses.flat}, {"still", losses.still}}},
                {"ratios", {{"flat", value(losses.flat)}, {"still", value(losses.still)}}}};
  };
  Json json{{"triplets", triplets_}};
  json.update(told(whole()));
  json["landed"] = Json{{"share", landed_share()}};
  json["landed"].update(told(landed()));
  return json;
}

std::string DataContrast::to_text() const {
  std::string text = fmt::format("{:<28}{:>9}{:>9}{:>9}{:>12}{:>13}\n", "image loss", "ideal", "flat", "still",
                                 "flat/ideal", "still/ideal");
  const auto add_row = [&](const std::string& name, const PredictionLosses& losses) {
    const auto shown = [&](double loss) {
      const auto r = ratio(loss, losses.ideal);
      return r ? fmt::format("{:.2f}", *r) : "-";
    };
    text += fmt::format("{:<28}{:>9.2f}{:>9.2f}{:>9.2f}{:>12}{:>13}\n", name, losses.ideal, losses.flat,
                        losses.still, shown(losses.flat), shown(losses.still));
  };
  add_row("whole image", whole());
  add_row(fmt::format("where all land, {:.0f} %", 100 * landed_share()), landed());
  return text +
         "ideal: predicted with true masks, depth and motion; flat: with the image's mean depth everywhere; "
         "still: as if\nonly the camera moved. A ratio well above 1: depth (flat), or knowing that objects "
         "move (still), has much of the\nimage loss to win. About 1: nothing.\n";
}

}  // namespace vkopple
