//! The catalogue: operators, presets and formats with their parameters.
