// SPDX-License-Identifier: Apache-2.0
// JoinedField: the walkers of several volumes as one, so that a ray function looks at all parts of a collection together.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "render/volume/medium/stretch.h"

namespace sg::volume {

/// Stretches of all parts from near to far, as values of the first part (stored, its base). Where parts overlap, the one that began first
/// continues.
class JoinedField final : public RayField {
 public:
  explicit JoinedField(std::span<const RaySource* const> sources);

  void start(Vec3 origin, Vec3 direction, double from, double to) override;
  size_t next(std::span<Stretch> out) override;
  double entry() const override;
  Vec3f gradient(const Stretch& stretch, double t) override;
  float second(const Stretch& stretch, double t) override;
  int samples(const Stretch& stretch, double t, float values[8], float shares[8]) override;
  bool bend(const Stretch& stretch, double t, SecondDerivatives& h) override;

 private:
  struct Part {
    std::unique_ptr<RayField> walker;
    float rise = 0;  // from its stored values to those of the first part
    Stretch ahead[16];
    size_t next = 0, count = 0;
    bool peek();
  };
  struct Given {  // stretch number `cell` of this ray
    size_t part;
    uint64_t cell;
  };
  Stretch of_part(const Stretch& s) const;
  RayField& walker(const Stretch& s) { return *parts_[given_[size_t(s.cell)].part].walker; }

  std::vector<Part> parts_;
  std::vector<Given> given_;
  double done_ = 0;
};

}  // namespace sg::volume
