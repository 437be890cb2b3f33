//! Files from elsewhere that are wrong or damaged.

mod bad_hulls;
mod bad_input;
mod corpus;
mod damage;
mod finite;
mod mutated_data;
mod mutated_input;
