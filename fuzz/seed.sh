#!/usr/bin/env bash
# Fills the corpora with small valid files made by the command itself.
set -euo pipefail
cd "$(dirname "$0")"
mkdir -p corpus/{case,model,obj,gltf,stl,lut,run,track,experiments,glide,exr,msh,vtu,heights,recording,mdf4,matlab73,fmu,three_mf,parquet,matlab,results}
kufe() { cargo run --release --quiet --manifest-path ../Cargo.toml -p kufe-cli -- "$@"; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
kufe init "$scratch/case.toml" --quiet
kufe init "$scratch/table.toml" --kind table --quiet
kufe init "$scratch/model.toml" --kind model --quiet
kufe init "$scratch/mapping.toml" --kind mapping --quiet
printf 's_m,slope_rad,curvature_1pm,bank_rad\n0,0.1,0,0\n50,0.1,0,0\n100,0.1,0,0\n150,0.1,0,0\n' > "$scratch/track.csv"
cp "$scratch/mapping.toml" corpus/recording/mapping
cp "$scratch/case.toml" corpus/case/example
cp "$scratch/model.toml" corpus/model/example
hull=(hull bob --length-m 0.05 --height-m 0.01 --edge-length-m 0.01 --quiet)
kufe "${hull[@]}" -o corpus/obj/bob.obj
kufe "${hull[@]}" -o corpus/gltf/bob.glb
kufe "${hull[@]}" -o corpus/stl/bob.stl
kufe lut "$scratch/table.toml" -o corpus/lut/example --fmu=corpus/fmu/example.fmu --mat=corpus/matlab/example.mat --quiet
kufe press "$scratch/case.toml" -o "$scratch/out" --quiet
cp "$scratch/out/pressure.exr" corpus/exr/example
cp "$scratch/out/result.json" corpus/results/contact
cp ../cli/tests/data/fit.json corpus/results/fit
kufe simulate "$scratch/model.toml" "$scratch/track.csv" --most-s 1 --parquet -o "$scratch/runs" --quiet
cp "$scratch/runs/"*.parquet corpus/parquet/
kufe mesh "$scratch/case.toml" -o "$scratch/mesh" --quiet
find "$scratch/mesh" -name '*.vtu' -size -200k -exec cp {} corpus/vtu/ \;
printf '$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n0\n$EndNodes\n' > corpus/msh/empty
printf 't_s,v_mps\n0,5\n0.05,4.99\n' > corpus/glide/example
printf 'x_m,y_m,z_m\n0,0,0\n1,0,0\n0,1,0\n1,1,1e-6\n' > corpus/heights/example
printf 's_m,slope_rad,curvature_1pm,bank_rad\n0,0.1,0,0\n10,0.1,0.01,0.2\n' > corpus/track/example
printf 'specimen,p_max_pa,p_max_sd_pa,mu,mu_sd\na,8e6,3e5,0.0048,0.0002\n' > corpus/experiments/example
printf 't_s,ax_mps2,ay_mps2,az_mps2,roll_rate_radps,pitch_rate_radps,yaw_rate_radps,v_mps,alpha_rad,delta_rad,gamma_rad\n0,0,0,9.81,0,0,0,30,0,0,0\n' > corpus/run/example
printf 'Fahrt;3\n\nZeit;Lenkwinkel\nms;°\n0;1,5\n10;1,6\n' > corpus/recording/german
printf 'Time,GPS Speed [km/h],Lateral Acc [g]\n0.00,91.5,0.1\n0.05,91.6,\n' > corpus/recording/example
# Logs of the two binary formats, by the packages that the tests compare with.
if [ -n "${KUFE_PYTHON:-}" ]; then
    "$KUFE_PYTHON" - <<'END'
import h5py, numpy as np
from asammdf import MDF, Signal
t = np.arange(40) / 20.0
for name, compression in (("plain", 0), ("packed", 2)):
    log = MDF(version="4.10")
    log.append([Signal(np.sin(t), t, name="a", unit="g"), Signal(np.arange(40).astype("i2"), t, name="n")])
    log.save(f"corpus/mdf4/{name}.mf4", compression=compression, overwrite=True)
with h5py.File("corpus/matlab73/run.mat", "w", userblock_size=512, libver=("earliest", "latest")) as f:
    f.create_dataset("t", data=t[None], chunks=(1, 20), compression="gzip")
    f.create_group("gps").create_dataset("v", data=np.cos(t)[None])
END
fi
