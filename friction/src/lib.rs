//! Ice friction: ice-house glides, mu(p), lateral friction.
