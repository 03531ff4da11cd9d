"""Runs a Spack recipe against a stand-in of Spack's directives: it is Python that Spack can load, it asks for what the crate
needs, and its install does what it should, in this order.

    spack_recipe.py PACKAGE.PY CARGO.TOML
"""

import re
import sys
import tempfile
import types
from pathlib import Path
from unittest.mock import MagicMock


def main() -> None:
    recipe, crate = (Path(argument) for argument in sys.argv[1:])
    said: dict[str, list[tuple]] = {name: [] for name in ("version", "license", "depends_on", "cargo", "mpjr")}

    def directive(name):
        return lambda *words, **options: said[name].append((*words, options))

    def undecorated(*_words, **_options):
        return lambda method: method

    package = types.ModuleType("spack.package")
    package.Package = type("Package", (), {})
    for name in ("version", "license", "depends_on"):
        setattr(package, name, directive(name))
    package.run_after = package.on_package_attributes = undecorated
    package.which = lambda _name: lambda *words: said["cargo"].append(words)
    package.Executable = lambda _path: lambda *words, **options: said["mpjr"].append(words)
    package.mkdirp = lambda *_paths: None
    package.join_path = lambda *parts: "/".join(map(str, parts))
    sys.modules["spack"] = types.ModuleType("spack")
    sys.modules["spack.package"] = package

    names: dict = {}
    exec(compile(recipe.read_text(), str(recipe), "exec"), names)
    mpjr = names["Mpjr"]
    assert mpjr.__doc__ and said["version"] and said["license"] == [("MIT OR Apache-2.0", {})]

    needed = {re.match(r"[a-z0-9-]+", words[0]).group(): words[0] for words in said["depends_on"]}
    assert {"rust", "pkgconfig", "llvm", "mpi", "petsc", "hdf5"} <= set(needed), needed
    oldest = re.search(r'rust-version = "(.*)"', crate.read_text()).group(1)
    assert needed["rust"] == f"rust@{oldest}:", f"{needed['rust']}: Cargo.toml asks for {oldest}"
    first, last = re.search(r'VERSIONS: \[&str; 2\] = \["(.*)", "(.*)"\]', (crate.parent / "build.rs").read_text()).groups()
    assert needed["petsc"].startswith(f"petsc@{first}:{last}+mpi+mumps~complex+double"), needed["petsc"]

    environment = MagicMock()
    one = mpjr()
    one.spec, one.stage, one.prefix = MagicMock(), MagicMock(), MagicMock()
    one.setup_build_environment(environment)
    variables = {call.args[0] for call in environment.set.call_args_list}
    assert {"PETSC_DIR", "HDF5_DIR", "MPICC", "LIBCLANG_PATH"} <= variables, variables
    with tempfile.TemporaryDirectory() as directory:
        package.join_path = names["join_path"] = lambda *parts: f"{directory}/{parts[-1]}"
        one.install(one.spec, one.prefix)
    one.check_install()
    assert said["cargo"][0][:2] == ("install", "--locked"), said["cargo"]
    assert [words[0] for words in said["mpjr"]] == ["man", "completions", "verify"], said["mpjr"]
    print(f"{recipe.name}: {len(needed)} dependencies: {', '.join(needed.values())}")


if __name__ == "__main__":
    main()
