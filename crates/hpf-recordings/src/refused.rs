//! Formats that are known and not read: each by its name, with the command that makes one that is read.

/// The first bytes of a format, its name, and the command that converts it.
struct Known {
    magic: &'static [u8],
    name: &'static str,
    command: &'static str,
}

const KNOWN: [Known; 6] = [
    Known {
        magic: b"#ROSBAG V",
        name: "a bag of ROS 1",
        command: "rosbags-convert --src FILE --dst FOLDER --dst-storage mcap (pip install rosbags)",
    },
    Known {
        magic: b"SQLite format 3\0",
        name: "an SQLite file, as bags of ROS 2 with the ending .db3 are",
        command: "rosbags-convert --src FOLDER_OF_THE_BAG --dst FOLDER --dst-storage mcap (pip install rosbags; or ros2 bag convert)",
    },
    Known {
        magic: b"\x89HDF\r\n\x1a\n",
        name: "an HDF5 file, as .mat files of MATLAB since 7.3 are",
        command: "python3 -c 'import h5py, numpy as n; f = h5py.File(\"FILE\"); d = {}; f.visititems(lambda k, v: d.update({k.replace(\"/\", \".\"): v[()]}) if hasattr(v, \"dtype\") else None); n.savez(\"FILE.npz\", **d)'",
    },
    Known {
        magic: b"MATLAB 5.0",
        name: "a .mat file of MATLAB",
        command: "python3 -c 'import scipy.io as s, numpy as n; m = s.loadmat(\"FILE\"); n.savez(\"FILE.npz\", **{k: v for k, v in m.items() if k[0] != \"_\"})'",
    },
    Known {
        magic: b"PAR1",
        name: "a Parquet file, as LeRobot data sets are",
        command: "python3 -c 'import pandas as p; p.read_parquet(\"FILE\").to_csv(\"FILE.csv\", index=False)'",
    },
    Known {
        magic: b"\x80\x04\x95",
        name: "a pickle of Python",
        command: "python3 -c 'import pandas as p; p.DataFrame(p.read_pickle(\"FILE\")).to_csv(\"FILE.csv\", index=False)'",
    },
];

/// Why `bytes` are not read, where they are of a known format that is not.
pub fn known(bytes: &[u8]) -> Option<String> {
    let known = KNOWN.iter().find(|known| bytes.starts_with(known.magic))?;
    Some(format!("this is {}, which is not read; this converts it: {}", known.name, known.command))
}
