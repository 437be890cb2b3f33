#!/usr/bin/env bash
# Fills the corpora with small valid files made by the command itself.
set -euo pipefail
cd "$(dirname "$0")"
mkdir -p corpus/{case,obj,gltf,stl}
kufe() { cargo run --release --quiet --manifest-path ../Cargo.toml -p kufe -- "$@"; }
kufe init --force corpus/case/example --quiet
hull=(hull bob --length-m 0.05 --height-m 0.01 --edge-length-m 0.01 --quiet)
kufe "${hull[@]}" -o corpus/obj/bob.obj
kufe "${hull[@]}" -o corpus/gltf/bob.glb
kufe "${hull[@]}" -o corpus/stl/bob.stl
