// SPDX-License-Identifier: Apache-2.0
// Agreement of two label fields.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct DiceParams {
  FieldName field;
  FieldName truth;
};
void describe(Schema& s, DiceParams& p);

/// One row per label that occurs in either field, ascending: label, count, truth (samples that bear it there), both, dice = 2 both / (count
/// + truth) (Dice 1945), jaccard = both / (count + truth - both). Hidden and duplicate samples and those where either is NaN are left
/// out. Any mesh; two fields of one association. Throws Error(usage) for fields that hold other than whole numbers.
TablePtr dice(const DatasetPtr& in, const DiceParams& p, Context& context);

}  // namespace sg
