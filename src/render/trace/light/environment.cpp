// SPDX-License-Identifier: Apache-2.0
#include "render/trace/light/environment.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "render/trace/light/luminance.h"
#include "render/trace/sampling/local_frame.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

struct Environment::Picture {
  std::vector<Vec3f> pixels;
  size_t width, height;
  LocalFrame frame;  // x in front, y to the left, z up
  Distribution2D brightness;
  Vec3f mean;

  /// Between the middles of pixels; at the poles and around it goes on.
  Vec3f at(Vec2f place) const {
    const float x = place.x * float(width) - 0.5f, y = std::clamp(place.y * float(height) - 0.5f, 0.f, float(height - 1));
    const float left = std::floor(x), wx = x - left;
    const size_t x0 = left < 0 ? width - 1 : std::min(size_t(left), width - 1), x1 = x0 + 1 < width ? x0 + 1 : 0;
    const size_t y0 = std::min(size_t(y), height - 1), y1 = std::min(y0 + 1, height - 1);
    const float wy = y - float(y0);
    const auto row = [&](size_t r) { return pixels[r * width + x0] * (1 - wx) + pixels[r * width + x1] * wx; };
    return row(y0) * (1 - wy) + row(y1) * wy;
  }
  /// Of the angle from `up` at a row's upper edge, and by how much it falls to the lower one.
  float cosine(size_t row) const { return float(std::cos(double(pi) * double(row) / double(height))); }
  float drop(size_t row) const {
    const double step = double(pi) / double(height);
    return float(std::cos(step * double(row)) - std::cos(step * double(row + 1)));
  }
  /// From a density over the square to one over the sphere.
  float per_solid_angle(size_t row) const { return 1 / (float(height) * 2 * pi * drop(row)); }
};

namespace {

// A pixel's share of the sphere falls towards the poles: by the mean sine over its row.
double sine_of_row(size_t row, size_t height) {
  const double step = double(pi) / double(height);
  return (std::cos(step * double(row)) - std::cos(step * double(row + 1))) / step;
}

/// The mean of the interpolated picture over each pixel: 1/8, 6/8, 1/8 of three along each axis, going around in x.
std::vector<Vec3f> means(const std::vector<Vec3f>& pixels, size_t width) {
  const size_t height = pixels.size() / width;
  std::vector<Vec3f> across(pixels.size()), out(pixels.size());
  for (size_t y = 0; y < height; ++y)
    for (size_t x = 0; x < width; ++x) {
      const Vec3f* row = &pixels[y * width];
      across[y * width + x] = (row[(x + width - 1) % width] + row[(x + 1) % width]) * 0.125f + row[x] * 0.75f;
    }
  for (size_t y = 0; y < height; ++y)
    for (size_t x = 0; x < width; ++x)
      out[y * width + x] = (across[(y > 0 ? y - 1 : y) * width + x] + across[std::min(y + 1, height - 1) * width + x]) * 0.125f +
                           across[y * width + x] * 0.75f;
  return out;
}

std::vector<float> weights(std::span<const Vec3f> pixels, size_t width) {
  std::vector<float> w(pixels.size());
  for (size_t i = 0; i < w.size(); ++i) w[i] = luminance(pixels[i]) * float(sine_of_row(i / width, pixels.size() / width));
  return w;
}

}  // namespace

Environment::Environment(std::span<const Vec3f> pixels, size_t width, Vec3 up, Vec3 front, float factor) {
  if (width == 0 || pixels.empty() || pixels.size() % width != 0)
    fail_usage("has no pixels", "environment", "give a picture of all directions");
  std::vector<Vec3f> scaled;
  Vec3 mean;
  const size_t height = pixels.size() / width;
  for (size_t i = 0; i < pixels.size(); ++i) {
    const Vec3f p = pixels[i] * factor;
    for (int c = 0; c < 3; ++c)
      if (!(p[c] >= 0 && std::isfinite(p[c])))
        fail_usage(fmt::format("pixel {},{} is {}", i % width, i / width, p[c]), "environment", "light is finite and not negative");
    scaled.push_back(p);
  }
  const std::vector<Vec3f> smooth = means(scaled, width);
  for (size_t i = 0; i < smooth.size(); ++i)
    mean += Vec3(smooth[i]) * (sine_of_row(i / width, height) * double(pi) / (2 * double(pixels.size())));
  Distribution2D brightness(weights(smooth, width), width);
  const Vec3f z(normalize(up));
  const LocalFrame about = LocalFrame::about(z, Vec3f(normalize(front)));
  picture_ = std::make_shared<Picture>(Picture{std::move(scaled), width, height, about, std::move(brightness), Vec3f(mean)});
}

Vec2f Environment::place(Vec3f direction) const {
  const Vec3f d = picture_->frame.to_local(direction);
  // The left of the middle column is what lies to the left: y.
  const float around = std::atan2(d.y, d.x), down = std::acos(std::clamp(d.z, -1.f, 1.f));
  const auto below_one = [](float v) { return std::clamp(v, 0.f, 1 - 0x1p-24f); };
  return {below_one(0.5f - around / (2 * pi)), below_one(down / pi)};
}

Vec3f Environment::radiance(Vec3f direction) const {
  if (picture_) return picture_->at(place(direction));
  Vec3f sum = even_;
  for (const Side& side : sides_) {
    if (side.radiance == Vec3f()) continue;
    const float t = std::clamp((dot(direction, side.towards) - side.least) / (1 - side.least), 0.f, 1.f);
    sum += side.radiance * (t * t * (3 - 2 * t));
  }
  return sum;
}

Vec3f Environment::mean() const {
  if (picture_) return picture_->mean;
  // Half of its strength, on average over the part of the sphere where a side gives light.
  Vec3f sum = even_;
  for (const Side& side : sides_) sum += side.radiance * ((1 - side.least) / 4);
  return sum;
}

Environment::Sample Environment::sample(Vec2f u) const {
  if (!picture_) {
    const Vec3f d = uniform_sphere(u);
    return {d, radiance(d), uniform_sphere_pdf()};
  }
  // Even over each pixel's part of the sphere: in a row the cosine is what is drawn evenly.
  const Distribution2D::Sample s = picture_->brightness.sample(u);
  const float in_rows = s.point.y * float(picture_->height);
  const size_t row = std::min(size_t(in_rows), picture_->height - 1);
  const float around = (0.5f - s.point.x) * 2 * pi, z = picture_->cosine(row) - (in_rows - float(row)) * picture_->drop(row);
  const float sine = std::sqrt(std::max(0.f, 1 - z * z));
  const Vec3f d = normalize(picture_->frame.to_world({std::cos(around) * sine, std::sin(around) * sine, z}));
  return {d, radiance(d), s.pdf * picture_->per_solid_angle(row)};
}

float Environment::pdf(Vec3f direction) const {
  if (!picture_) return uniform_sphere_pdf();
  const Vec2f at = place(direction);
  return picture_->brightness.pdf(at) * picture_->per_solid_angle(std::min(size_t(at.y * float(picture_->height)), picture_->height - 1));
}

}  // namespace sg::trace
