// SPDX-License-Identifier: Apache-2.0
// A prepared picture at a size and from a camera.
#include <algorithm>
#include <variant>

#include "base/error.h"
#include "pipeline/picture/prepare.h"

namespace sg {

namespace {

bool has_nan(const Scene& scene) {
  for (const Item& item : scene.items) {
    const bool nan = std::visit(
        [](const auto& i) {
          using T = std::remove_cvref_t<decltype(i)>;
          const Field* f = nullptr;
          if constexpr (std::is_same_v<T, VolumeItem>) return false;  // seen through, not painted
          else {
            if (i.color_by && !i.color_by->direct) f = i.data->fields().find(i.color_by->field, i.color_by->association);
            return f && i.data->stats(*f).nan > 0;
          }
        },
        item);
    if (nan) return true;
  }
  return false;
}

Annotation annotation_of(const StatedPicture& stated, const Shown& shown, const CameraDefaults& defaults) {
  Annotation a;
  a.legends = shown.legends;
  a.title = stated.picture.title, a.caption = stated.picture.caption, a.notes = stated.notes;
  a.scale_bar = stated.picture.scale_bar;
  a.triad = stated.picture.triad && shown.any_points && !defaults.parallel;  // a map needs none: its axes are named
  a.scale = stated.picture.text;
  const double brightness = 0.2126 * stated.bottom.x + 0.7152 * stated.bottom.y + 0.0722 * stated.bottom.z;
  a.dark_background = !stated.transparent && brightness < 0.45;
  a.show_nan_in_legend = has_nan(shown.scene);
  if ((stated.picture.axes || a.scale_bar) && !shown.box.empty()) a.box = shown.box;
  a.axes = stated.picture.axes;
  std::copy_n(shown.axis_titles, 3, a.axis_titles);
  a.length_unit = shown.length_unit;
  a.stretch = shown.stretch;
  a.patient_letters = stated.picture.letters && shown.patient;
  return a;
}

// A projection of all values, such as the maximum along each ray, covers the edges behind it but for their ends.
bool fills_its_box(const Scene& scene) {
  return std::any_of(scene.items.begin(), scene.items.end(), [](const Item& item) {
    const auto* volume = std::get_if<VolumeItem>(&item);
    return volume && !info_of(volume->mode).absorbs && !info_of(volume->mode).needs_level;
  });
}

// Ready to be drawn at the size that is stated.
Panel panel_of(const Shown& shown, const CameraDefaults& defaults, const StatedPicture& stated, const CameraParams& camera) {
  Panel p;
  p.scene = shown.scene;
  p.scene.background = stated.bottom, p.scene.background_top = stated.top, p.scene.transparent = stated.transparent;
  p.scene.lighting = stated.lighting, p.scene.lighting.up = defaults.axes.up, p.scene.lighting.front = defaults.axes.front;
  p.annotation = annotation_of(stated, shown, defaults);
  if (in_panels(stated.picture)) p.annotation.legends.clear();  // they stand beside the panels
  const Rect area = picture_beside_legends(p.annotation, stated);
  const double aspect = std::max(1.0, area.width) / std::max(1.0, area.height);
  p.around = defaults, p.margin = stated.picture.axes ? 0.11 : 0.05;
  p.camera = make_camera(camera, shown.box, aspect, defaults, p.margin);
  Box3 all = scene_bounds(p.scene);  // glyphs reach beyond the data
  all.add(shown.box);
  fit_planes(p.camera, all);
  if (stated.picture.axes && !shown.outlined && !shown.box.empty() && !fills_its_box(p.scene)) {
    p.scene.items.emplace_back(back_edges(shown.box, p.camera));
    p.box_behind = shown.box;
  }
  return p;
}

}  // namespace

Panel panel_of(const PreparedPicture& prepared, const StatedPicture& stated) {
  return panel_of(prepared.shown[0], prepared.camera, stated, stated.camera);
}

Picture draw_prepared(const PreparedPicture& prepared, const StatedPicture& stated, const PictureOptions& options, Context& context) {
  const std::vector<Shown>& shown = prepared.shown;
  Picture picture;
  picture.notes = prepared.notes, picture.legends = shown[0].legends;
  if (!in_panels(stated.picture)) {
    const Panel panel = panel_of(prepared, stated);
    if (options.on_panel && !options.on_panel(panel, stated)) return picture;
    draw_drafts(panel.scene, panel.camera, stated, panel.annotation, options, picture, context);
    return picture;
  }
  if (options.on_panel)
    fail_usage("a page shows one picture, not several panels", "layout", "leave out layout and views: its buttons turn to every side");
  const std::vector<std::string>& views = stated.picture.views;
  const size_t count = views.empty() ? shown.size() : views.size();
  Annotation around = annotation_of(stated, shown[0], prepared.camera);
  // The panels share the legends: one with places without a value has them tell of it.
  around.show_nan_in_legend = std::any_of(shown.begin(), shown.end(), [](const Shown& s) { return has_nan(s.scene); });
  const StatedPicture inside = inside_layout(stated, around, count);
  std::vector<NamedPanel> panels;
  for (size_t i = 0; i < count; ++i) {
    CameraParams camera = stated.camera;
    if (!views.empty()) camera.view = view_named(views[i]);
    // Straight on nothing is nearer: what is seen lies between the numbers of its axes, whose names tell their directions.
    const bool straight = !views.empty() && camera.view != NamedView::iso && !camera.projection;
    if (straight) camera.projection = ProjectionKind::parallel;
    panels.push_back(
        {views.empty() ? prepared.panel_titles[i] : views[i], panel_of(shown[views.empty() ? i : 0], prepared.camera, inside, camera)});
    if (straight) panels.back().panel.annotation.triad = false;
  }
  DrawnPicture drawn = draw_layout(panels, stated, inside, around, {.on_light = options.on_light}, context);
  picture.image = std::move(drawn.image), picture.seen = std::move(drawn.seen);
  return picture;
}

}  // namespace sg
