// SPDX-License-Identifier: Apache-2.0
// The picture without its legends, and the box behind the data.
#include "pipeline/picture/picture_parts.h"
#include "render/render.h"

namespace sg {

namespace {

// Where a picture narrowed by its legends lies in the whole one: at the left, the rest is background.
void place_left(const Frame& part, Frame& whole) {
  for (int y = 0; y < part.height; ++y) {
    const size_t from = size_t(y) * size_t(part.width), to = size_t(y) * size_t(whole.width);
    std::copy_n(&part.rgba[4 * from], 4 * size_t(part.width), &whole.rgba[4 * to]);
    // The background continues to the right.
    for (int x = part.width; x < whole.width; ++x)
      std::copy_n(&part.rgba[4 * (from + size_t(part.width) - 1)], 4, &whole.rgba[4 * (to + size_t(x))]);
  }
}

// The texts whose places are seen: nothing lies before them by more than a hair of the scene's size.
std::vector<TextItem> seen_texts(const Scene& scene, const Projection& p, const Frame& frame) {
  const double hair = scene.texts.empty() ? 0 : 0.005 * scene_bounds(scene).diagonal();
  std::vector<TextItem> seen;
  for (const TextItem& t : scene.texts) {
    const Vec3 at = p.to_pixel(t.at);
    if (!(at.z > p.near_plane && at.z < p.far_plane) || !(at.x >= 0 && at.x < frame.width && at.y >= 0 && at.y < frame.height)) continue;
    if (double(frame.depth[size_t(at.y) * size_t(frame.width) + size_t(at.x)]) >= at.z - hair) seen.push_back(t);
  }
  return seen;
}

}  // namespace

// The edges of the box that do not lie in front of the data: those with a face turned away from the camera.
LinesItem back_edges(const Box3& box, const Camera& camera) {
  // turned_away[axis][end]: does the face at that end look away from the camera?
  bool turned_away[3][2];
  const Vec3 towards = camera.position - camera.target;
  for (int a = 0; a < 3; ++a) {
    turned_away[a][0] = camera.parallel ? towards[a] >= 0 : camera.position[a] >= box.lo[a];
    turned_away[a][1] = camera.parallel ? towards[a] <= 0 : camera.position[a] <= box.hi[a];
  }
  SurfaceMesh mesh;
  mesh.points.origin = box.center();
  std::vector<float> xyz;
  std::vector<int32_t> ends;
  for (int c = 0; c < 8; ++c)
    for (int a = 0; a < 3; ++a) xyz.push_back(float((c >> a & 1 ? box.hi[a] : box.lo[a]) - mesh.points.origin[a]));
  for (int c = 0; c < 8; ++c)
    for (int a = 0; a < 3; ++a) {
      const int u = (a + 1) % 3, v = (a + 2) % 3;
      if ((c >> a & 1) || !(box.size()[a] > 0)) continue;
      if (turned_away[u][c >> u & 1] || turned_away[v][c >> v & 1]) ends.insert(ends.end(), {c, c | 1 << a});
    }
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.lines.fixed = 2;
  mesh.lines.connectivity = Array::from_vector(std::move(ends));
  LinesItem item;
  item.data = make_dataset(std::move(mesh));
  item.color = {0.69f, 0.69f, 0.71f};
  item.width = 1;
  return item;
}

int width_beside_legends(const Annotation& annotation, const StatedPicture& s) {
  const int legends = legend_width(annotation, s.width, s.height);
  return legends * 2 > s.width ? s.width : s.width - legends;  // too narrow a picture: legends go over it
}

Image draw_picture(const Scene& scene, const Camera& camera, const StatedPicture& s, const Annotation& annotation, double coarser,
                   Context& context) {
  RenderOptions options;
  options.width = width_beside_legends(annotation, s), options.height = s.height, options.samples = s.picture.samples;
  options.adaptive = s.picture.adaptive, options.coarser = coarser;
  // The frame, one of single samples, and one of all columns if a legend is next to it.
  check_picture_memory(s.width, s.height, 1 + (options.width < s.width || options.adaptive > 0 ? 1 : 0));
  Frame frame = render(scene, camera, options, context);
  const Projection projection = make_projection(camera, options.width, options.height);
  Annotation with_texts = annotation;
  with_texts.texts = seen_texts(scene, projection, frame);
  for (Legend& l : with_texts.legends)
    if (l.glyph && annotation.box) {
      const double depth = projection.to_eye(annotation.box->center()).z;
      l.glyph->pixels = l.glyph->in_pixels    ? l.glyph->length
                        : projection.parallel ? l.glyph->length * projection.scale
                        : depth > 0           ? l.glyph->length * projection.scale / depth
                                              : 0;
    }
  if (options.width < s.width) {
    Frame whole(s.width, s.height);
    // The last column may hold data; take the background's own colour there.
    Scene empty;
    empty.background = scene.background, empty.background_top = scene.background_top, empty.transparent = scene.transparent;
    RenderOptions column = options;
    column.width = 1, column.samples = 1;
    const Frame background = render(empty, camera, column, context);
    place_left(frame, whole);
    for (int y = 0; y < s.height; ++y)
      for (int x = options.width; x < s.width; ++x)
        std::copy_n(&background.rgba[4 * size_t(y)], 4, &whole.rgba[4 * (size_t(y) * size_t(s.width) + size_t(x))]);
    frame = std::move(whole);
  }
  Image image = to_image(frame, scene.transparent);
  annotate(image, with_texts, projection);
  return image;
}

}  // namespace sg
