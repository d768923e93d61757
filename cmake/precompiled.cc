// Headers are precompiled for a source: this one.
