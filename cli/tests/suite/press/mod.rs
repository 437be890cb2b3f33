//! One contact or a series of them, and what is written for other programs.

mod compare;
mod elastic;
mod export;
mod gallery;
mod hull_check;
mod hull_made;
mod mesh;
mod one_case;
mod optimum;
mod series;
mod sliding;
mod sliding_laws;
mod stiffness;
