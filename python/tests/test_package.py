"""The package as a whole: its types are those of the compiled module, its examples run."""

import ast
import inspect
import os
import pathlib
import re
import runpy

import pytest

import kufe
from test_contact import PARABOLOID
from test_table import TABLE


def test_the_stubs_name_what_the_module_has():
    tree = ast.parse(pathlib.Path(os.environ["KUFE_STUBS"]).read_text())
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            same_parameters(node, getattr(kufe, node.name))
        if isinstance(node, ast.ClassDef):
            kind = getattr(kufe, node.name)
            stubbed = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
            if issubclass(kind, Exception):
                continue
            real = {name for name in vars(kind) if not name.startswith("_")}
            assert stubbed - {"__new__"} == real, node.name
            for item in node.body:
                if isinstance(item, ast.FunctionDef):
                    found = kind if item.name == "__new__" else getattr(kind, item.name)
                    if callable(found):
                        same_parameters(item, found)
    stubbed = {n.name for n in tree.body if isinstance(n, (ast.FunctionDef, ast.ClassDef))}
    assert stubbed | {"__version__", "Error", "InputError", "NotConvergedError"} == set(kufe.__all__)


def same_parameters(stub, function):
    arguments = stub.args
    if stub.name == "__new__":
        del arguments.args[0]
    names = arguments.args + arguments.kwonlyargs
    shown = inspect.signature(function).parameters
    assert [a.arg for a in names] == list(shown), stub.name
    of_names = [None] * (len(arguments.args) - len(arguments.defaults)) + arguments.defaults
    for name, default in zip(names, of_names + arguments.kw_defaults, strict=True):
        stated = inspect.Parameter.empty if default is None else ast.literal_eval(default)
        assert shown[name.arg].default == stated, (stub.name, name.arg)


def test_every_class_function_and_property_is_documented_in_the_stub():
    tree = ast.parse(pathlib.Path(os.environ["KUFE_STUBS"]).read_text())
    for node in tree.body:
        members = node.body if isinstance(node, ast.ClassDef) else []
        for item in [node, *members]:
            if isinstance(item, (ast.ClassDef, ast.FunctionDef)):
                assert ast.get_docstring(item), (node.name, item.name)


def test_everything_public_is_described():
    for name in kufe.__all__:
        if name != "__version__":
            assert getattr(kufe, name).__doc__, name
    assert re.fullmatch(r"\d+\.\d+\.\d+", kufe.__version__)


def test_the_first_block_of_the_documentation_runs(tmp_path, monkeypatch):
    text = pathlib.Path(os.environ["KUFE_PAGE"]).read_text()
    block = text.split("```python\n")[1].split("```")[0]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(PARABOLOID)
    (tmp_path / "front.toml").write_text(TABLE)
    names = {}
    exec(compile(block, "python.md", "exec"), names)
    assert names["contact"].fz_n == pytest.approx(2000.0)
    assert names["p"].shape == (2,) and (tmp_path / "bob.stl").exists()


EXAMPLES = sorted((pathlib.Path(__file__).parent.parent / "examples").glob("*.py"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_example_runs_and_draws(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(path), run_name="__main__")
    pictures = list(tmp_path.glob("*.png"))
    assert pictures and all(picture.stat().st_size > 10_000 for picture in pictures)


def test_there_is_an_example():
    assert EXAMPLES
