#pragma once

namespace lipofill::coupling {

/// METIS, which CHOLMOD's nested dissection bisects with, seeds and draws from rand() of the C
/// library: one generator for the whole process, so that two orderings at once, or anyone else who
/// draws meanwhile, make an ordering another than it is alone. A program that links this library
/// has a rand() and srand() of its own in their place: the same numbers, from a generator for each
/// thread. Whoever calls METIS calls this, which links the two into the program and says whether
/// METIS finds them. Checked by tests/property/determinism_test.cc.
bool has_random_numbers_of_its_own();

}  // namespace lipofill::coupling
