// SPDX-License-Identifier: Apache-2.0
// samples: the points of a sampler, as text, JSON and a picture. lookdev: a ball of each material on one sheet.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "cli/cli.h"
#include "cli/say.h"
#include "image/codec.h"
#include "render/annotate/contact_sheet.h"
#include "render/trace/lookdev.h"
#include "render/trace/sampling/sample_study.h"

namespace sg {

int run_samples(const Options& o, Context& context) {
  trace::SampleStudyParams params;
  Schema schema = schema_of(params);
  set_params(schema, o.samples, "samples");
  const trace::SampleStudy study = trace::study_samples(params);
  if (o.json) {
    std::string points;
    for (const Vec2f u : study.points)
      points += fmt::format("{}[{},{}]", points.empty() ? "" : ",", exact_number(double(u.x)), exact_number(double(u.y)));
    std::printf("{\"sampler\":%s,\"count\":%d,\"discrepancy\":%s,\"relative_error\":%s,\"points\":[%s]}\n",
                json_string(std::string(word_of(params.sampler))).c_str(), params.count, exact_number(study.discrepancy).c_str(),
                exact_number(study.relative_error).c_str(), points.c_str());
  } else {
    std::printf("%s, %d samples per pixel\n", std::string(word_of(params.sampler)).c_str(), params.count);
    std::printf("  L2 star discrepancy of those of one pixel: %s\n", short_number(study.discrepancy, 4).c_str());
    std::printf("  error of the mean of exp(x + y): %s of that of independent samples\n", short_number(study.relative_error, 3).c_str());
  }
  if (!o.output.empty()) write_image(o.output, trace::sample_picture(params, context));
  return 0;
}

int run_lookdev(const Options& o, Context& context) {
  constexpr int balls_wide = 240;
  std::vector<CaptionedImage> balls;
  const std::string output = o.output.empty() ? "lookdev.png" : o.output;
  std::vector<std::string> names = o.inputs;
  std::vector<MaterialPreset> shown;
  if (names.empty())
    for (const auto& [word, preset] : enum_words(MaterialPreset{}))
      if (std::find(shown.begin(), shown.end(), preset) == shown.end()) shown.push_back(preset), names.emplace_back(word);
  for (size_t i = 0; i < names.size(); ++i) {
    const auto preset = value_of_word<MaterialPreset>(names[i]);
    if (!preset) {
      std::vector<std::string> known;
      for (const auto& [word, value] : enum_words(MaterialPreset{})) known.emplace_back(word);
      fail_usage(fmt::format("there is no material '{}'", names[i]), "sightglass lookdev", unknown_name_hint(names[i], known));
    }
    Context part(context, double(i) / double(names.size()), double(i + 1) / double(names.size()));
    balls.push_back({lookdev_ball(preset_material(*preset, 2 * std::sqrt(3.0)), balls_wide, o.noise, part), names[i]});
  }
  write_image(output, balls.size() == 1 ? balls[0].image : contact_sheet(balls, 5, balls_wide));
  if (!o.quiet) say(fmt::format("{}: {} materials\n", printable(output), balls.size()));
  return 0;
}

}  // namespace sg
