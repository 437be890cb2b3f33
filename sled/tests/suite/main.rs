//! The one-track sled against identities, closed forms, a real car and its own simulation; refusal
//! of faulty files.

mod align;
mod effects_in_commands;
mod effects_in_the_loop;
mod real_car;
mod recorded;
mod replay;
mod rigid_body;
mod round_trip;
mod sample_statements;
mod simulation;
mod tables_of_mu;
