// SPDX-License-Identifier: Apache-2.0
// Statistics of fields, as tables.
#pragma once
#include <span>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct StatisticsParams {
  std::vector<std::string> fields;
};
inline void describe(Schema& s, StatisticsParams& p) { s("fields", p.fields, "Fields to describe; default: all on points and cells."); }

/// One row per component of each field (and one for the magnitude of a vector): field, association, component, count, missing (NaN),
/// infinite, min, quartile1, median, quartile3, max, mean, deviation (of the sample: n-1), sum, sum_of_squares: all but `missing` and
/// `infinite` of the finite values; a warning names fields with infinities. Hidden and duplicate cells and points
/// are left out. Quartiles by linear interpolation between order statistics (Hyndman and Fan 1996, type 7). Sums are exact to the last
/// places for any number of threads (fixed chunks, each summed with Neumaier's compensation). O(n) memory for the order statistics.
TablePtr statistics(const DatasetPtr& in, const StatisticsParams& p, Context& ctx);
/// One table of all parts: fields of the same name, place and number of components are one.
TablePtr statistics_of_all(std::span<const DatasetPtr> parts, const StatisticsParams& p, Context& ctx);

struct HistogramParams {
  FieldName field;
  int component = -1;
  int bins = 64;
  std::optional<double> min, max;
};
inline void describe(Schema& s, HistogramParams& p) {
  s("field", p.field, "Field to count; default: the active scalar.");
  s("component", p.component, "Component of the field; -1: the magnitude of a field of several.").at_least(-1);
  s("bins", p.bins, "Number of bins.").range(1, 1 << 20);
  s("min", p.min, "Lower end of the first bin; default: the smallest value.").unit("@field");
  s("max", p.max, "Upper end of the last bin; default: the largest value.").unit("@field");
}
/// Columns lo, hi, count, fraction: a value v lies in the bin with lo <= v < hi, the last bin holds its upper end too. Values outside
/// and NaN are in no bin, nor are infinities, which a warning counts; fractions are of all finite values.
TablePtr histogram(const DatasetPtr& in, const HistogramParams& p, Context& ctx);

}  // namespace sg
