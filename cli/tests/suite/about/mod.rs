//! The command's help, documents and licences.

mod book;
mod book_blocks;
mod habits;
mod info;
mod licences;
mod schema;
mod written;
