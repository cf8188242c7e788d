// Tables, figures and summary of `prt measure rotation`.
#pragma once

#include <span>

#include "tools/measure/output.h"
#include "tools/measure/rotation_cost.h"
#include "tools/measure/rotation_errors.h"
#include "tools/measure/rotation_hsh.h"

namespace prt::tools {

struct RotationResults {
    std::vector<RotationCost> costs;
    std::vector<TaylorError> errors;
    std::vector<HshError> hshErrors;
    std::vector<HshTableError> hshTables;
};

/// Tables `rows`, `errors`, `hsh_errors`, `hsh_tables` and `paper_times`; figures of times (PREFIX), of
/// Taylor errors as [Krivanek2006, Fig. 3] (-errors) and of hemispherical harmonics (-hsh). What does not
/// apply is null in JSON, empty in CSV.
Measurement rotationMeasurement(const RotationResults& results);

}  // namespace prt::tools
