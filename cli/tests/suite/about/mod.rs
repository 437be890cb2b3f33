//! What the command says of itself, its documents and its licences.

mod book;
mod book_blocks;
mod habits;
mod info;
mod licences;
mod schema;
mod written;
