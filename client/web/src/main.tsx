import { render } from "preact";
import { App } from "./app";
import "./style.css";
import "./pages.css";
import "./screens.css";

render(<App />, document.getElementById("page")!);
