"use strict";
(() => {
  const dark = matchMedia("(prefers-color-scheme: dark)");

  // ---- libraries, models and data are packed blocks; each is unpacked once, when it is needed.
  const contents = new Map();
  function unpacked(block) {
    if (!contents.has(block)) {
      const text = block.textContent;
      const bytes = Uint8Array.fromBase64
        ? Uint8Array.fromBase64(text) : Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
      contents.set(block, new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).blob());
    }
    return contents.get(block);
  }
  const read = new Map(); // texts of blocks that are unpacked
  async function textOf(block) {
    const blob = await unpacked(block);
    if (!read.has(block)) read.set(block, await blob.text());
    return read.get(block);
  }

  // A library runs when the first thing that needs it is shown. The policy knows its digest.
  const libraries = {};
  for (const block of document.querySelectorAll("script.library")) libraries[block.dataset.name] = block;
  const running = new Set();
  function run(name) {
    if (running.has(name)) return;
    running.add(name);
    const script = document.createElement("script");
    script.textContent = read.get(libraries[name]);
    document.head.append(script);
  }
  // A page that draws all the time has no idle time at all: the wait ends.
  const wait = 500; // ms
  const idle = () => new Promise((done) => {
    if (window.requestIdleCallback) requestIdleCallback(done, { timeout: wait }); else setTimeout(done, wait);
  });

  // ---- tables: a click on a heading sorts, and once more turns the order round; a button copies.
  const number = (text) => {
    const found = /^[+-]?(\d+\.?\d*(e[+-]?\d+)?)/i.exec(text.trim().replace("−", "-"));
    return found ? parseFloat(found[0]) : NaN;
  };
  const texts = (row) => [...row.cells].map((cell) => cell.textContent.trim());

  function sort(table, column, heading) {
    const body = table.tBodies[0];
    const down = heading.getAttribute("aria-sort") === "ascending";
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    heading.setAttribute("aria-sort", down ? "descending" : "ascending");
    const rows = [...body.rows].map((row, place) => [texts(row)[column], row, place]);
    const whole = rows.every(([text]) => text === "–" || !Number.isNaN(number(text)));
    rows.sort(([a, , i], [b, , j]) => {
      const empty = (a === "–") - (b === "–");
      if (empty) return empty;
      const order = whole && a !== "–" ? number(a) - number(b) : a.localeCompare(b);
      return (down ? -order : order) || i - j;
    });
    body.append(...rows.map(([, row]) => row));
  }

  async function copy(table, button) {
    const rows = [...table.tHead.rows, ...table.tBodies[0].rows];
    const text = rows.map((row) => texts(row).join("\t")).join("\n").replaceAll("\u00a0", " ");
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      const area = document.createElement("textarea");
      area.value = text;
      document.body.append(area);
      area.select();
      document.execCommand("copy");
      area.remove();
    }
    button.textContent = "Copied";
    setTimeout(() => { button.textContent = "Copy"; }, 1500);
  }

  for (const table of document.querySelectorAll("main table")) {
    [...table.tHead.rows[0].cells].forEach((heading, column) => {
      if (!heading.textContent) return;
      const button = document.createElement("button");
      button.type = "button";
      button.className = "sort";
      button.append(...heading.childNodes);
      button.addEventListener("click", () => sort(table, column, heading));
      heading.append(button);
    });
    const button = document.createElement("button");
    button.type = "button";
    button.className = "copy";
    button.textContent = "Copy";
    button.title = "Copy the table, its columns apart by tabs";
    button.addEventListener("click", () => copy(table, button));
    table.parentElement.after(button);
  }

  // ---- shapes: one viewer, into which the chosen model is unpacked.
  const viewer = document.querySelector("model-viewer");
  if (viewer) {
    const models = [...document.querySelectorAll("script.model")];
    const choices = [...document.querySelectorAll("[data-shape]")];
    const told = document.querySelector(".viewer .told");
    const pause = document.querySelector(".viewer .pause");
    const addresses = new Map();

    async function address(place) {
      if (!addresses.has(place)) {
        const model = new Blob([await unpacked(models[place])], { type: "model/gltf-binary" });
        addresses.set(place, URL.createObjectURL(model));
      }
      return addresses.get(place);
    }

    let chosen = -1; // the last choice counts, whichever model is unpacked first
    async function choose(place) {
      chosen = place;
      told.textContent = `${models[place].dataset.title}\n${models[place].dataset.note}`.trim();
      for (const choice of choices) choice.setAttribute("aria-pressed", String(+choice.dataset.shape === place));
      pause.textContent = "Pause";
      const [source] = await Promise.all([address(place), textOf(libraries["model-viewer"])]);
      run("model-viewer");
      if (chosen === place) viewer.src = source;
    }

    viewer.addEventListener("load", () => viewer.play());
    pause.addEventListener("click", () => {
      if (!viewer.loaded) return;
      if (viewer.paused) viewer.play(); else viewer.pause();
      pause.textContent = viewer.paused ? "Play" : "Pause";
    });
    const byPicture = new Map();
    for (const choice of choices) {
      choice.addEventListener("click", () => choose(+choice.dataset.shape));
      byPicture.set(choice.dataset.picture, choice);
    }
    for (const figure of document.querySelectorAll("figure[data-picture]")) {
      const choice = byPicture.get(figure.dataset.picture);
      if (!choice) continue;
      const button = document.createElement("button");
      button.type = "button";
      button.className = "move";
      button.textContent = "Turn and play";
      button.addEventListener("click", () => {
        choose(+choice.dataset.shape);
        viewer.scrollIntoView({ block: "center" });
        viewer.focus();
      });
      figure.querySelector("figcaption").append(" ", button);
    }
    const follow = () => {
      const target = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
      const choice = target && target.querySelector(":scope > [data-shape]");
      if (choice) {
        choose(+choice.dataset.shape);
        viewer.scrollIntoView({ block: "center" });
      }
      return choice;
    };
    addEventListener("hashchange", follow);
    // The first shape is unpacked when the viewer comes into sight.
    const seen = new IntersectionObserver(async (entries) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      seen.disconnect();
      await idle();
      if (chosen < 0) choose(0);
    });
    if (!follow()) seen.observe(viewer);
  }

  // ---- curves: drawn when they come into sight, and again in the other colours.
  const drawings = [...document.querySelectorAll("script.drawing")];
  const frames = [...document.querySelectorAll(".plot")];
  const data = (frame) => drawings[+frame.dataset.plot];

  function draw(frame) {
    run("plotly");
    const { x, y, z, curves, value, axes, logarithmic } = JSON.parse(read.get(data(frame)));
    const ink = dark.matches ? "#e3e7ea" : "#1d2125";
    const rule = dark.matches ? "#343b42" : "#e4e7ea";
    const axis = { gridcolor: rule, zerolinecolor: rule, linecolor: ink, exponentformat: "power", automargin: true };
    const layout = {
      font: { family: "system-ui, sans-serif", size: 13, color: ink },
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
      margin: { l: 48, r: 16, t: 36, b: 52 }, hovermode: "closest",
      modebar: { bgcolor: "rgba(0,0,0,0)", color: "#8a9097", activecolor: ink },
      xaxis: { ...axis, title: { text: axes[0] } },
      yaxis: { ...axis, title: { text: lines(curves ? value : axes[1]), standoff: 6 }, type: curves && logarithmic ? "log" : "linear" },
      legend: { orientation: "h", y: 1.14, x: 0 },
    };
    let traces;
    if (curves) {
      traces = curves.map(({ name, y: values }) => ({
        type: "scatter", mode: "lines", name: escaped(name), x, y: values.map((one) => (one > 0 || !logarithmic ? one : null)),
        line: { width: 1.2 }, hovertemplate: "%{x:.6g}: %{y:.4g}<extra>%{fullData.name}</extra>",
      }));
    } else {
      const shown = logarithmic ? z.map((row) => row.map((one) => (one > 0 ? Math.log10(one) : null))) : z;
      traces = [{
        type: "heatmap", x, y, z: shown, customdata: z, colorscale: "Viridis",
        colorbar: { title: { text: logarithmic ? `lg ${value}` : value, side: "right" }, thickness: 14 },
        hovertemplate: "%{x:.5g}, %{y:.5g}: %{customdata:.4g}<extra></extra>",
      }];
    }
    Plotly.react(frame, traces, layout, {
      responsive: true, displaylogo: false, modeBarButtonsToRemove: ["lasso2d", "select2d"],
      showSendToCloud: false, plotlyServerURL: "", // data stay in the page
    });
  }
  // Names of axes on lines of some thirty letters.
  const lines = (text) => escaped(text).replace(/(.{18,30}) /g, "$1<br>");
  // Plotly reads some tags in names.
  const escaped = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");

  if (frames.length) {
    const drawn = new Set();
    const unpack = (frame) => Promise.all([textOf(libraries.plotly), textOf(data(frame))]);
    const show = (frame) => {
      draw(frame);
      drawn.add(frame);
      frame.parentElement.classList.add("drawn");
    };
    const near = new IntersectionObserver((entries) => {
      for (const entry of entries) {
        if (!entry.isIntersecting) continue;
        near.unobserve(entry.target);
        unpack(entry.target).then(() => show(entry.target));
      }
    }, { rootMargin: "300px" });
    frames.forEach((frame) => near.observe(frame));
    dark.addEventListener("change", () => drawn.forEach(draw));

    // Paper shows all curves. A page that is printed waits for nothing, so they are unpacked beforehand; none is
    // drawn, and no library runs, before it is printed.
    addEventListener("load", async () => {
      for (const frame of frames) {
        await idle();
        await unpack(frame);
      }
    });
    addEventListener("beforeprint", () => {
      for (const frame of frames) if (read.has(libraries.plotly) && read.has(data(frame))) show(frame);
    });
  }
})();
