// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/picture.h"

#include <fmt/format.h>

#include <ranges>

#include "base/error.h"
#include "base/schema/color_params.h"
#include "base/text/text.h"
#include "color/parse_color.h"
#include "data/memory/memory_budget.h"
#include "pipeline/film/film_params.h"
#include "pipeline/offline/page_params.h"
#include "pipeline/picture/picture_parts.h"
#include "pipeline/picture/prepare.h"
#include "pipeline/picture/report/picture_notes.h"
#include "pipeline/picture/scene/shutter.h"
#include "scene/light/light_params.h"
#include "scene/show/show.h"

namespace sg {

void describe(Schema& s, PictureParams& p) {
  s("size", p.size, "Width and height in pixels, e.g. 1920x1080; HD is that, 4K 3840x2160, 8K 7680x4320.");
  s("background", p.background, "Background colour, two colours bottom/top for a gradient, or 'transparent'.").unit(color_unit);
  s("title", p.title,
    "Title above the picture; {t} is the time of the data, {t:.2f} with two decimals, in a series {n} the number of the picture and "
    "{count} that of all.");
  s("legend", p.legend, "Draw the colour legends.");
  s("axes", p.axes, "Draw the bounding box with numbers.");
  s("stretch", p.stretch,
    "Factors by which x, y and z are drawn longer than they are, negative ones the other way round; numbers at the axes stay those of the "
    "data. Default: 1,1,1, but for maps in degrees (longitudes as long as at the middle latitude, heights 0.3 times the map's "
    "width), depths and pressures, which grow downwards. The camera's position and target are where things are drawn.");
  s("x_title", p.x_title, "Title of the x axis; default: what the data says of it, else x.");
  s("y_title", p.y_title, "Title of the y axis.");
  s("z_title", p.z_title, "Title of the z axis.");
  s("frame", p.frame,
    "The box that the picture is of: x0,x1,y0,y1,z0,z1 in the data's coordinates. Axes and camera are those of the box; what lies outside "
    "of it "
    "is drawn where it comes into view. Default: all of the data, or of a volume shown without options the part in which something is "
    "seen.");
  s("layout", p.layout,
    "Several panels in one picture, with one legend: columns x rows as 2x1, or 'auto'. Each input has its own, or each of 'views'.");
  s("views", p.views, "Named views of the same data side by side, e.g. front,left,top,iso; layout 'auto' where none is stated.");
  s("scale_bar", p.scale_bar, "Draw a bar of a round length, as long as it is at the middle of the data.");
  s("caption", p.caption, "Text at the lower edge of the picture; {t} as in the title.");
  s("note", p.note,
    "Texts in the picture with their places, apart by semicolons: 'Inlet @ 0.1,0.9; Outlet @ top-right size=1.5 color=red'. A place is the "
    "middle of the text in shares of the picture's width and height from the top left, or top-left, top, top-right, left, center, right, "
    "bottom-left, bottom or bottom-right; {t} as in the title.");
  s("measurements", p.measurements,
    "What was measured in a window, which keeps it here: 'Width @ 0,0,0 1,2,3; Angle @ 0,0,0 1,0,0 1,1,0', names with their places in the "
    "data, apart by semicolons. Not drawn.");
  s("triad", p.triad, "Draw the orientation axes.");
  s("letters", p.letters,
    "Draw at the edges of a scan's picture where they lie in the patient: right, left, anterior, posterior, inferior, superior.");
  s("samples", p.samples,
    "Samples per pixel and axis; 0 chooses 2 for surfaces (of level sets that rays meet where they differ), 1 for volumes.")
      .range(0, 4);
  s("adaptive", p.adaptive,
    "Above 0: take all samples only where neighbouring pixels differ by more than this share of full scale; 0: take all of them "
    "everywhere.")
      .range(0, 1);
  s("text", p.text, "Scale factor of all text.").range(0.2, 10);
  s("integrator", p.integrator,
    "Light by rays instead of the rasterizer: path follows all light from surface to surface, whitted direct light, mirrors and glass, "
    "ambient_occlusion light from everywhere that is stopped by what is near. For light that mirrors and glass focus: light starts from "
    "the "
    "lamps and shows nothing in mirrors or glass, bdpt from both ends, metropolis does so in chains that stay where it is bright. Default: "
    "none.");
  s("noise", p.light.noise,
    "With an integrator: a part of the picture is finished when its standard error is below this share of full scale; light, bdpt and "
    "metropolis finish all of it together.")
      .range(0.0001, 1);
  s("paths", p.light.paths, "With an integrator: most paths per pixel.").range(1, 1 << 20);
  s("seconds", p.light.seconds,
    "With an integrator: seconds after which the picture stops, all of it as far as it has come, and says which noise it has reached. The "
    "recipe then has the paths in 'stop' in place of them. 0: no limit.")
      .range(0, 1e6)
      .unit("s");
  s("stop", p.light.stop,
    "With an integrator: the picture stops at this number of paths per pixel, as one that seconds=... has stopped there. 0: at 'paths'.")
      .range(0, 1 << 20);
  s("denoise", p.light.denoise,
    "With an integrator: take each pixel's light from all pixels near it that look alike as far as noise can tell, guided by colours, "
    "directions and distances of what is seen. What is finer than the noise is lost.");
  s("bounces", p.light.bounces, "With an integrator: most turns of a path.").range(0, 1000);
  s("sampler", p.light.sampler, "With an integrator: how the random numbers of a pixel lie to each other (see: sightglass samples).");
  s("seed", p.seed, "With an integrator: another number draws other paths, with other noise.").range(0, 1e9);
  s("lights", p.lights,
    fmt::format("Lights apart by semicolons, each a kind and words: 'rectangle from=left-above size=0.5; sphere from=right "
                "brightness=0.3', 'sun elevation=20'. Kinds: {} (sightglass ops KIND). Without an integrator each becomes a direction. "
                "Default: two from the viewer's sides.",
                fmt::join(light_kinds() | std::views::transform(&LightKind::name), ", ")));
  s("environment", p.environment,
    "With an integrator: what shines from all around. 'sky elevation=20', 'even brightness=0.5', the name of a picture of all directions "
    "with 'rotate=90', or none. Default: a soft sky that is bright above the viewer, a dim even sky where lights are stated; none beside "
    "the lights where it is stated.");
}

void parse_size(const std::string& words, int& width, int& height) {
  const std::string name = to_lower(words);
  const std::string text = name == "4k" || name == "uhd" ? "3840x2160" : name == "8k" ? "7680x4320" : name == "hd" ? "1920x1080" : words;
  const auto parts = split(text, 'x');
  const auto w = parts.size() == 2 ? parse_int(parts[0]) : std::nullopt, h = parts.size() == 2 ? parse_int(parts[1]) : std::nullopt;
  if (!w || !h || *w < 1 || *h < 1 || *w > 32768 || *h > 32768)
    fail_usage(fmt::format("'{}' is not a size", text), "size", "write width x height from 1 to 32768, e.g. 1280x720, or HD, 4K or 8K");
  width = int(*w), height = int(*h);
}

PipelineVocabulary picture_vocabulary() {
  PipelineVocabulary v;
  v.show = {std::string(auto_show)};
  for (const ShowKind& k : show_kinds()) v.show.emplace_back(k.name);
  v.picture = {"camera"};
  const auto add = [&](const Schema& schema) {
    for (const ParamDecl& d : schema.decls()) v.picture.push_back(d.name);
  };
  FilmParams film;
  add(schema_of(film));
  PageParams page;
  add(schema_of(page));
  PictureParams p;
  add(schema_of(p));
  return v;
}

StatedPicture stated_in(const PipelineFile& file) {
  StatedPicture s;
  std::vector<std::string> words;
  for (const std::string& w : file.picture)
    if (!w.starts_with("camera.") && !w.starts_with("camera=") && !is_film_word(w)) words.push_back(w);
  Schema schema = schema_of(s.picture);
  set_params(schema, words, "picture");
  Schema camera = schema_of(s.camera);
  std::vector<std::string> camera_list = words_under(file.picture, "camera");
  if (const auto whole = word_value(file.picture, "camera")) camera_list = quoted_words(*whole);
  set_params(camera, camera_words(camera_list), "camera");
  parse_size(s.picture.size, s.width, s.height);
  s.notes = parse_notes(s.picture.note);
  s.lighting.lights = parse_lights(s.picture.lights);
  s.lighting.environment = parse_environment(s.picture.environment);
  if (const std::vector<double>& f = s.picture.frame; !f.empty() && !(f.size() == 6 && f[0] <= f[1] && f[2] <= f[3] && f[4] <= f[5]))
    fail_usage("frame needs the lower and the upper end along x, y and z", "frame", "like frame=0,1,0,1,0,0.5");
  if (s.picture.background == "transparent") {
    s.transparent = true;
  } else {
    const auto parts = split(s.picture.background, '/');
    if (parts.empty() || parts.size() > 2)
      fail_usage(fmt::format("'{}' is not a background", s.picture.background), "background", "write e.g. white, or white/skyblue");
    s.bottom = parse_color(parts[0], "background");
    if (parts.size() == 2) s.top = parse_color(parts[1], "background");
  }
  return s;
}

Picture make_picture(PipelineFile& file, const PictureOptions& options, Context& context) {
  Context computing(context, 0, 0.5), drawing(context, 0.5, 1);
  PictureOptions shared = options;
  // Moments find what does not move.
  if (!shared.cache && stated_in(file).camera.shutter > 0) shared.cache = std::make_shared<Cache>(allowed_memory() / 2);
  const PreparedPicture prepared = prepare_picture(file, shared, computing);
  const std::vector<PipelineFile> moments = moments_of(file, prepared.stated.camera);
  if (moments.empty() && prepared.stated.camera.shutter > 0)
    context.info("nothing moves while the shutter is open: nodes with keys do, and steps that state a time");
  Picture picture =
      moments.empty() ? draw_prepared(prepared, prepared.stated, options, drawing) : draw_moments(moments, prepared, shared, drawing);
  if (!in_panels(prepared.stated.picture) && !picture.image.pixels.empty()) {
    // The same picture on any machine.
    std::erase_if(file.picture, [](const std::string& w) { return w.starts_with("seconds="); });
    if (picture.stopped > 0) {
      std::erase_if(file.picture, [](const std::string& w) { return w.starts_with("stop="); });
      file.picture.push_back(fmt::format("stop={}", picture.stopped));
    }
  }
  context.progress(1, "done");
  return picture;
}

}  // namespace sg
