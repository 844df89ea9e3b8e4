// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/cursors/solid_cursor.h"

#include "data/cells/shape/cell_map_geometry.h"

namespace sg {

SolidCursor::SolidCursor(const FlowAccess& access, PointVectors vectors) : access_(&access), v_(vectors) {
  if (!access.curvilinear) map_.emplace(access.mesh());
  if (access.any_hidden) hidden_.emplace(access.mesh());
}

SolidCursor::Found SolidCursor::find(Vec3 x) {
  const WalkStart& start = *access_->start;
  if (!start.may_hold(x)) return Found::outside;
  if (cell_ < 0) {
    const int32_t c = start.near(x);
    if (c < 0) return Found::lost;
    open(c);
  }
  int64_t before = -1;
  bool quick = true;
  for (int n = 0; n < 256; ++n) {
    FaceExit exit;
    if (!look(x, quick, exit)) return Found::lost;
    if (exit.face == -1) return Found::here;
    if (n == 12) {  // x is far from the last place: there is a nearer cell to begin at
      const int32_t c = start.near(x);
      if (c < 0) return Found::lost;
      open(c);
      before = -1, quick = true;
      continue;
    }
    const int64_t next = exit.face < 0 ? -1 : across(exit.face);
    if (next < 0) {
      if (!quick) return Found::lost;
      quick = false;  // once more, to the end
      continue;
    }
    if (hidden_ && hidden_->hidden(size_t(next))) return Found::lost;
    // To and fro: the first guess was wrong.
    quick = next != before;
    before = cell_;
    const Vec3 r = linear_.at();
    open(next);
    // In a grid the axes go on; elsewhere they are arbitrary.
    if (access_->curvilinear) {
      Vec3 q = r;
      q[exit.face / 2] += exit.face % 2 ? -1 : 1;
      for (int a = 0; a < 3; ++a) linear_.at()[a] = std::clamp(q[a], 0.0, 1.0);
    }
  }
  return Found::lost;
}

bool SolidCursor::set(int64_t cell, Vec3 x) {
  if (cell != cell_) open(cell);
  if (kind_ == Kind::linear) linear_.start_in_middle();
  if (kind_ == Kind::curved) place_.rst = {HUGE_VAL, 0, 0};
  FaceExit exit;
  if (!look(x, false, exit)) return false;
  return exit.face == -1 || (kind_ != Kind::polyhedron && exit.outside <= 1e-6);
}

int64_t SolidCursor::across(int face) const {
  if (!access_->curvilinear) return (*access_->neighbors)(size_t(cell_), size_t(face));
  const int axis = face / 2;
  const bool up = face % 2;
  const auto cells = access_->curvilinear->view().cell_dims();
  const size_t stride = axis == 0 ? 1 : axis == 1 ? cells[0] : cells[0] * cells[1];
  const size_t i = size_t(cell_) / stride % cells[size_t(axis)];
  if (up ? i + 1 == cells[size_t(axis)] : i == 0) return -1;
  return up ? cell_ + int64_t(stride) : cell_ - int64_t(stride);
}

void SolidCursor::open(int64_t cell) {
  cell_ = cell, weighed_ = false;
  const CellType type = access_->curvilinear ? CellType::hexahedron : access_->cell_type(size_t(cell));
  if (LinearCell::knows(type)) return open_linear(size_t(cell), type);
  map_->open(size_t(cell));
  const CellReader& reader = map_->reader();
  box_ = reader.box().size(), size_ = sg::length(box_);
  double far = 0;
  for (const Vec3 p : reader.at()) far = std::max({far, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  tolerance_ = locate_tolerance + (size_ > 0 ? 4 * std::numeric_limits<double>::epsilon() * far / size_ : 0);
  u_.resize(reader.ids().size());
  for (size_t k = 0; k < u_.size(); ++k) u_[k] = v_(size_t(reader.ids()[k]));
  place_ = {};
  if (const CellShape* shape = shape_of(*map_)) {
    kind_ = Kind::curved, base_ = shape->base(), middle_ = shape->center();
    place_.rst = {HUGE_VAL, 0, 0};
  } else {
    kind_ = Kind::polyhedron;
    open_polyhedron();
  }
}

void SolidCursor::open_linear(size_t cell, CellType type) {
  kind_ = Kind::linear;
  Vec3 p[8], u[8];
  const int n = LinearCell::corners_of(type);
  if (access_->curvilinear) {
    static constexpr int corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    const LatticeView& v = access_->curvilinear->view();
    const auto cells = v.cell_dims();
    const size_t i = cell % cells[0], j = cell / cells[0] % cells[1], k = cell / cells[0] / cells[1];
    for (int m = 0; m < 8; ++m) {
      const size_t a = i + size_t(corner[m][0]), b = j + size_t(corner[m][1]), c = k + size_t(corner[m][2]);
      id_[m] = int64_t(v.id(a, b, c)), p[m] = v.position(a, b, c);
    }
  } else {
    for (int m = 0; m < n; ++m) p[m] = access_->simplices.point(id_[m] = access_->simplices.id(cell, m));
  }
  for (int m = 0; m < n; ++m) u[m] = v_(size_t(id_[m]));
  linear_.open(type, id_, p, u);
  linear_.start_in_middle();
}

// The planes of the faces' triangles, and whether all points lie behind all of them.
void SolidCursor::open_polyhedron() {
  const auto at = map_->reader().at();
  const auto triangles = surface_of(*map_);
  planes_.clear(), plane_face_.clear();
  convex_ = true;
  faces_ = map_->reader();  // a copy lists the faces
  for (size_t f = 0, n = faces_->face_count(); f < n; ++f)
    if (const size_t corners = faces_->face(f).size(); corners > 2) plane_face_.insert(plane_face_.end(), corners - 2, int(f));
  for (size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const Vec3 a = at[triangles[t]], n = cross(at[triangles[t + 1]] - a, at[triangles[t + 2]] - a);
    const double l = sg::length(n);
    planes_.push_back({l > 1e-14 * size_ * size_ ? n / l : Vec3(), a});
    for (const Vec3 p : at) convex_ = convex_ && dot(planes_.back().normal, p - a) <= 1e-12 * size_;
  }
}

bool SolidCursor::look(Vec3 x, bool quick, FaceExit& exit) {
  weighed_ = false;
  switch (kind_) {
    case Kind::linear:
      if (!linear_.invert(x, quick)) return false;
      exit = linear_.exit();
      return true;
    case Kind::curved: return look_curved(x, quick, exit);
    case Kind::polyhedron: return look_polyhedron(x, exit);
    default: return false;
  }
}

// Newton from the last place in this cell, or its middle.
bool SolidCursor::look_curved(Vec3 x, bool quick, FaceExit& exit) {
  Vec3 r = place_.rst.x < HUGE_VAL ? place_.rst : middle_;
  place_.rst = {HUGE_VAL, 0, 0};
  for (int n = 0; n < 20; ++n) {
    Vec3 column[3];
    const Vec3 miss = x - frame_of(*map_, r, column), c12 = cross(column[1], column[2]);
    const double det = dot(column[0], c12);
    if (!(std::abs(det) > 0)) return false;
    Vec3 step = Vec3(dot(miss, c12), dot(column[0], cross(miss, column[2])), dot(column[0], cross(column[1], miss))) / det;
    const double size = sg::length(step);
    if (!(size < 1e15)) return false;
    const Vec3 to = r + step;
    const double far = std::max({std::abs(to.x - 0.5), std::abs(to.y - 0.5), std::abs(to.z - 0.5)});
    // Beyond the cell the map bends away; the first steps from inside give the direction.
    if (quick && far > 1.5) {
      exit = exit_of(base_, to, tolerance_);
      return true;
    }
    if (size > 1) step *= 1 / size;
    r += step;
    if (size < 1e-9) {
      exit = exit_of(base_, r, tolerance_);
      place_.rst = r, place_.nearest = x, place_.distance2 = 0, place_.outside = exit.face < 0 ? 0 : exit.outside;
      return true;
    }
    if (far > 4) return false;
  }
  return false;
}

bool SolidCursor::look_polyhedron(Vec3 x, FaceExit& exit) {
  double most = -HUGE_VAL;
  size_t worst = 0;
  for (size_t t = 0; t < planes_.size(); ++t) {
    const double d = dot(planes_[t].normal, x - planes_[t].at);
    if (d > most) most = d, worst = t;
  }
  if (planes_.empty() || plane_face_.size() != planes_.size() || !std::isfinite(most)) return false;
  // Behind all planes is inside, whatever the shape; before one is outside of convex cells. Else, and close to the faces, by the rule of
  // the locator.
  const bool inside = most < -1e-12 * size_;
  if (!inside && !(convex_ && most > 2 * tolerance_ * size_)) {
    CellPlace place;
    if (map_->locate(x, place, locate_tolerance)) {
      place_ = place;
      return true;
    }
  }
  if (inside) {
    place_.nearest = x, place_.distance2 = 0, place_.outside = most / size_;
    return true;
  }
  exit = {plane_face_[worst], most / size_};
  return true;
}

Vec3 SolidCursor::velocity() {
  if (kind_ == Kind::linear) return linear_.velocity();
  weigh();
  Vec3 v;
  for (size_t k = 0; k < u_.size(); ++k) v += u_[k] * weights_[k];
  return v;
}

Mat3 SolidCursor::gradient() {
  if (kind_ == Kind::linear) return linear_.gradient();
  slopes_.resize(u_.size());
  map_->gradient_weights(place_, slopes_);
  Mat3 j;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      j.m[a][b] = 0;
      for (size_t k = 0; k < u_.size(); ++k) j.m[a][b] += u_[k][a] * slopes_[k][b];
    }
  return j;
}

double SolidCursor::length() {
  if (kind_ == Kind::linear) return linear_.length();
  const double largest = std::max({box_.x, box_.y, box_.z});
  double product = 1;
  int n = 0;
  for (int a = 0; a < 3; ++a)
    if (box_[a] > 1e-6 * largest) product *= box_[a], ++n;
  return n == 3 ? std::cbrt(product) : n == 2 ? std::sqrt(product) : product;
}

void SolidCursor::weigh() {
  if (weighed_) return;
  weighed_ = true;
  if (kind_ == Kind::linear) {
    linear_.corners(id_, weight_);
    return;
  }
  weights_.resize(u_.size());
  map_->weights(place_, weights_);
}

std::span<const int64_t> SolidCursor::ids() {
  weigh();
  if (kind_ == Kind::linear) return {id_, size_t(linear_.count())};
  return map_->reader().ids();
}

std::span<const double> SolidCursor::weights() {
  weigh();
  if (kind_ == Kind::linear) return {weight_, size_t(linear_.count())};
  return weights_;
}

}  // namespace sg
