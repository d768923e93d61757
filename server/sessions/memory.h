#pragma once

namespace lipofill::server {

/// Gives freed memory back to the system. The allocator holds on to what it gets back in the arena
/// of the thread that asked for it: without this a daemon that held eight simulations holds a third
/// of their memory when they have ended. Takes some milliseconds after a simulation of some ten
/// thousand unknowns.
void give_memory_back();

}  // namespace lipofill::server
