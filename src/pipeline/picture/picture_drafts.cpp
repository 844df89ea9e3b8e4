// SPDX-License-Identifier: Apache-2.0
// Pictures of volumes that memory does not hold, and by paths: one at once, finer ones as long as there is time.
#include <fmt/core.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "base/error.h"
#include "data/bricked.h"
#include "pipeline/picture/picture_parts.h"

namespace sg {

namespace {

using Clock = std::chrono::steady_clock;

// Cancels work at a time, unless it is over before.
class Deadline {
 public:
  Deadline(Context& work, std::optional<Clock::time_point> at) {
    if (at)
      thread_ = std::thread([this, &work, at] {
        std::unique_lock lock(mutex_);
        if (!over_.wait_until(lock, *at, [this] { return done_; })) work.cancel();
      });
  }
  ~Deadline() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    over_.notify_one();
    if (thread_.joinable()) thread_.join();
  }
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable over_;
  bool done_ = false;
  std::thread thread_;
};

// Pixels that a voxel of the level in memory covers where it is nearest; 0 without such a volume.
double pixels_in_memory(const Scene& scene, const Projection& p, std::string& made_of) {
  double most = 0;
  for (const Item& item : scene.items) {
    const auto* volume = std::get_if<VolumeItem>(&item);
    const BrickedPtr bricks = volume && volume->method == VolumeMethod::ray ? volume->data->bricks() : nullptr;
    const auto* grid = bricks ? volume->data->as<UniformGrid>() : nullptr;
    if (!grid) continue;
    const Box3 box = bricks->bounds();
    double nearest = HUGE_VAL;
    for (int c = 0; c < 8; ++c)
      nearest = std::min(nearest, p.to_eye({c & 1 ? box.hi.x : box.lo.x, c & 2 ? box.hi.y : box.lo.y, c & 4 ? box.hi.z : box.lo.z}).z);
    const double pixel = p.parallel ? 1 / p.scale : std::max(nearest, p.near_plane) / p.scale;
    const double covers = std::max({grid->spacing.x, grid->spacing.y, grid->spacing.z}) / pixel;
    if (covers <= most) continue;
    most = covers;
    size_t level = 0;
    while (level + 1 < bricks->levels.size() && bricks->levels[level].dims != grid->dims) ++level;
    made_of = fmt::format("level {} of {} ({}x{}x{})", level, bricks->levels.size(), grid->dims[0], grid->dims[1], grid->dims[2]);
  }
  return most;
}

void compare(const Image& a, const Image& b, PictureDraft& draft) {
  uint64_t sum = 0;
  int most = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const int d = std::abs(int(a.pixels[i]) - int(b.pixels[i]));
    most = std::max(most, d), sum += uint64_t(d);
  }
  draft.compared = true, draft.most = most / 255.0, draft.mean = double(sum) / 255.0 / double(std::max<size_t>(1, a.pixels.size()));
}

void draw_by_paths(const Scene& scene, const Camera& camera, const StatedPicture& stated, const Annotation& annotation,
                   const PictureOptions& options, Picture& picture, Context& context) {
  DrawHow how;
  how.until = options.until, how.layers = options.layers, how.on_light = options.on_light;
  const auto take = [&](DrawnPicture drawn) {
    picture.image = std::move(drawn.image), picture.seen = std::move(drawn.seen), picture.stopped = drawn.light.stopped;
    PictureDraft draft;
    draft.light = std::move(drawn.light);
    return draft;
  };
  if (options.on_draft)
    how.on_finer = [&](DrawnPicture drawn) {
      options.on_draft(picture, take(std::move(drawn)));
      return true;
    };
  PictureDraft last = take(draw_picture(scene, camera, stated, annotation, how, context));
  if (options.on_draft) picture.drafts.push_back(std::move(last));
}

}  // namespace

void draw_drafts(const Scene& scene, const Camera& camera, const StatedPicture& stated, const Annotation& annotation,
                 const PictureOptions& options, Picture& picture, Context& context) {
  if (follows_light(scene, stated)) return draw_by_paths(scene, camera, stated, annotation, options, picture, context);
  PictureDraft draft;
  const Rect area = picture_beside_legends(annotation, stated);
  const Projection p = make_projection(camera, int(area.width), int(area.height));
  const double coarsest = options.on_draft ? pixels_in_memory(scene, p, draft.made_of) : 0;
  const auto draw = [&](double coarser, Context& c) {
    return draw_picture(scene, camera, stated, annotation, {.coarser = coarser, .layers = options.layers, .on_light = options.on_light}, c);
  };
  const auto take = [&](DrawnPicture drawn) { picture.image = std::move(drawn.image), picture.seen = std::move(drawn.seen); };
  if (!(coarsest > 1)) {  // all is in memory, or fine enough there
    take(draw(1, context));
    return;
  }
  take(draw(0, context));
  draft.voxel_pixels = coarsest, draft.compared = false;
  options.on_draft(picture, draft);

  Context work(context, 0, 1);
  const Deadline deadline(work, options.until);
  try {
    // The error of the first picture shows in what half as many samples along each axis change.
    compare(picture.image, draw(2 * coarsest, work).image, draft);
    picture.drafts.push_back(draft);
    double pixels = 1;
    while (2 * pixels < 0.75 * coarsest) pixels *= 2;
    for (; pixels >= 1; pixels /= 2) {
      DrawnPicture finer = draw(pixels, work);
      draft.made_of = "bricks", draft.voxel_pixels = pixels;
      compare(finer.image, picture.image, draft);
      take(std::move(finer));
      picture.drafts.push_back(draft);
      if (pixels > 1) options.on_draft(picture, draft);
    }
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::cancelled || context.cancelled()) throw;
    if (picture.drafts.empty()) picture.drafts.push_back(draft);  // the time was over before anything could be compared
  }
}

}  // namespace sg
