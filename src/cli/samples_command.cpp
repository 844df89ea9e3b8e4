// SPDX-License-Identifier: Apache-2.0
// samples: the points of a sampler, as text, JSON and a picture.
#include <fmt/core.h>

#include <cstdio>

#include "base/text/text.h"
#include "cli/cli.h"
#include "image/codec.h"
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

}  // namespace sg
