#pragma once

#include <memory>

#include "alignment/prepared_model.h"

namespace recognition {

/// The prepared models of a database, all made: one set for all nodelets of the process that read it. Safe to use from
/// several threads; who asks while another thread makes them waits for it. Throws as PreparedModels does.
std::shared_ptr<const PreparedModels> sharedPreparedModels(const std::shared_ptr<const ModelDatabase>& database);

}  // namespace recognition
