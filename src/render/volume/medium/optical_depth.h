// SPDX-License-Identifier: Apache-2.0
// Optical depth along rays through any volume: what shadows and occlusion are made of.
#pragma once
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "render/volume/medium/medium.h"
#include "render/volume/medium/stretch.h"
#include "scene/items/volume_item.h"

namespace sg::volume {

struct Detail;

/// What takes light away: by the value alone, or with a second axis by the detail (which then stands for all of it).
struct Extinction {
  const Medium& medium;
  const Detail* detail = nullptr;
  Extinction(const Medium& m, const Detail* d = nullptr) : medium(m), detail(d) {}
};

/// The integral of tau over the length of stretches, by the antiderivative of tau over the value: a piece on which the value goes
/// straight takes constant time, however many knots or thin spikes of the medium it passes.
class DepthIntegral {
 public:
  explicit DepthIntegral(Extinction extinction);
  /// Optical depth, to 1e-4 (absolute) or better per stretch.
  double over(const Stretch& stretch) const;
  /// The same of the detail where there is one.
  double over(const Stretch& stretch, RayField& walker) const;
  /// Whether the value of a stretch may be taken for a straight line between any two places of it, to the same.
  bool straight(const Stretch& stretch) const;
  /// Mean of tau while the value goes straight from a to b.
  double mean(float a, float b) const;

 private:
  int chords(const Stretch& s, float lo, float hi) const;
  double antiderivative(float v) const;
  /// Of the shares [from, to] of a stretch, on which the value goes one way from a to b: cut where it meets knots.
  double between_knots(const Stretch& s, double from, double to, float a, float b) const;
  const Medium& medium_;
  const Detail* detail_;
  std::vector<double> before_;  // per line: the integral up to its reference
};

/// A ray and the part of it that planes leave of a volume.
struct DepthRay {
  Vec3 origin, direction;  ///< world; unit length
  double from = 0, to = HUGE_VAL;
  void clip(const std::vector<ClipPlane>& planes);
};

/// depth[i] = optical depth from ray.from to t = i * spacing; from depth `most` on the ray is not followed and the rest is HUGE_VALF.
void depths_along(const DepthRay& ray, RayField& walker, const DepthIntegral& integral, double spacing, float most, std::span<float> depth);

/// The last few things made of a dataset for light, with all that they depend on as the key.
template <class T>
class Recent {
 public:
  template <class Make>
  std::shared_ptr<const T> get(const std::string& key, size_t most, Make make) const {
    {
      const std::lock_guard lock(mutex_);
      for (size_t i = 0; i < things_.size(); ++i)
        if (things_[i].first == key) {
          const auto found = things_[i];
          things_.erase(things_.begin() + ptrdiff_t(i));
          things_.push_back(found);
          return found.second;
        }
    }
    auto made = std::make_shared<const T>(make());
    const std::lock_guard lock(mutex_);
    if (things_.size() >= most) things_.erase(things_.begin());
    things_.emplace_back(key, made);
    return made;
  }
  Recent() = default;
  Recent(Recent&& other) noexcept : things_(std::move(other.things_)) {}

 private:
  mutable std::mutex mutex_;
  mutable std::vector<std::pair<std::string, std::shared_ptr<const T>>> things_;
};

/// Everything of an item and its medium on which extinction in space depends, as bytes.
std::string extinction_key(const VolumeItem& item, const Extinction& extinction);
/// The bytes of numbers, behind a key.
void append_numbers(std::string& key, std::initializer_list<double> numbers);

}  // namespace sg::volume
