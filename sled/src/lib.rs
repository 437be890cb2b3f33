//! The one-track bobsled: measured runs, inverse model, fits, driver evaluation, simulation.
