"""Gallery of the worked examples: each is run while the site is built, and shown with what it prints and draws.

Outputs are kept in `build/gallery` under a digest of the example and of the library, so that they are made again where
either has changed.
"""

import ast
import os
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256
from pathlib import Path

_WORKERS = 2
# How an example takes the file or folder that it writes.
_FIGURE = "figure.savefig(sys.argv[1])"
_FOLDER = "folder = sys.argv[1] if"


def write_gallery(root: Path, folder: Path, rooms: tuple[str, ...]) -> None:
    """Run all examples that have changed, and write their pages and the gallery's index into a folder."""
    library = _digest(path for room in rooms for path in (root / room).rglob("*") if path.suffix in (".py", ".toml"))
    examples = root / "scripts" / "examples"
    cases = _digest(examples.glob("*.toml"))
    cache = root / "build" / "gallery"
    paths = sorted(examples.glob("*.py"))
    keys = {
        path: sha256(f"{library}{cases}{path.read_text(encoding='utf-8')}".encode()).hexdigest()[:16] for path in paths
    }
    folder.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(_WORKERS) as pool:
        outputs = list(pool.map(lambda path: _output(path, cache / f"{path.stem}-{keys[path]}", root), paths))
    entries = []
    for path, output in zip(paths, outputs, strict=True):
        pictures = []
        for number, picture in enumerate(sorted(output.glob("*.png"))):
            name = f"{path.stem}-{number}.png"
            shutil.copyfile(picture, folder / name)
            pictures.append(name)
        _write(folder / f"{path.stem}.md", _page(path, (output / "printed.txt").read_text(encoding="utf-8"), pictures))
        entries.append((path, pictures))
    _write(folder / "index.md", _index(entries))
    current = {folder.as_posix()} | {kept.as_posix() for kept in outputs}
    for old in cache.iterdir():
        if old.as_posix() not in current:
            shutil.rmtree(old)


def _digest(paths: object) -> str:
    whole = sha256()
    for path in sorted(paths):
        whole.update(path.as_posix().encode() + path.read_bytes())
    return whole.hexdigest()


def _output(path: Path, kept: Path, root: Path) -> Path:
    """Folder with what an example printed and drew; it is run where there is none yet."""
    if kept.is_dir():
        return kept
    source = path.read_text(encoding="utf-8")
    arguments = ["figure.png"] if _FIGURE in source else ["results"] if _FOLDER in source else []
    with tempfile.TemporaryDirectory() as work:
        environment = os.environ | {"PYTHONPATH": str(root), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        done = subprocess.run(
            [sys.executable, str(path), *arguments],
            cwd=work, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        if done.returncode:
            raise RuntimeError(f"{path.name} failed:\n{done.stderr}")
        made = kept.with_name(f"{kept.name}.new")
        shutil.rmtree(made, ignore_errors=True)
        made.mkdir(parents=True)
        (made / "printed.txt").write_text(done.stdout.replace(work, "."), encoding="utf-8")
        for picture in Path(work).rglob("*.png"):
            shutil.copyfile(picture, made / picture.name)
        made.rename(kept)
    return kept


def _title(path: Path) -> str:
    return path.stem.replace("_", " ").capitalize().replace("step file", "STEP file")


def _docstring(path: Path) -> str:
    return ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""


def _page(path: Path, printed: str, pictures: list[str]) -> str:
    source = path.read_text(encoding="utf-8")
    code = "".join(source.splitlines(keepends=True)[ast.parse(source).body[1].lineno - 1 :])
    parts = [f"# {_title(path)}", _docstring(path), f"```python\n{code}```"]
    if printed.strip():
        parts += ["It prints:", f"```text\n{printed.rstrip()}\n```"]
    parts += [f"![{_title(path)}]({name})" for name in pictures]
    parts.append(f"[Download the program](../../scripts/examples/{path.name}).")
    return "\n\n".join(parts) + "\n"


def _index(entries: list[tuple[Path, list[str]]]) -> str:
    parts = [
        "# Gallery of worked examples",
        "Each example is a program of at most 40 lines. It was run when this site was built, and a test runs it.",
        "::::{container} gallery",
    ]
    for path, pictures in entries:
        text = _docstring(path).split("\n\n")[0].replace("\n", " ")
        picture = f"\n[![{_title(path)}]({pictures[0]})]({path.stem}.md)\n" if pictures else ""
        parts.append(f":::{{container}} example\n{picture}\n[{_title(path)}]({path.stem}.md)\n\n{text}\n:::")
    parts += ["::::", "```{toctree}\n:hidden:\n\n" + "\n".join(path.stem for path, _ in entries) + "\n```"]
    return "\n\n".join(parts) + "\n"


def _write(path: Path, text: str) -> None:
    # An unchanged page keeps its time, so that the next build takes it from the last one.
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
