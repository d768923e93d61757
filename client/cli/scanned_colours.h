#pragma once

#include <vector>

#include "client/cpp/arrays.h"
#include "client/cpp/connection.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::client {

/// Adds "scan.colour", the colours of the scan's vertices, to the meshes of a simulation, where its
/// scan has some and is still there with the points that the simulation has. Otherwise the meshes
/// stay as they are: pictures then have the colour of skin. Checked by
/// tests/integration/cli/render_test.cc.
void add_scanned_colours(const Connection& connection, const v1::Simulation& simulation, std::vector<Array>* meshes);

}  // namespace lipofill::client
