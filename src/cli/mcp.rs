//! `planish mcp`: a server of the Model Context Protocol over standard input and output, for clients of language
//! models.

use std::path::PathBuf;
use std::sync::Arc;

use base64::prelude::{BASE64_STANDARD, Engine};
use rmcp::model::{
    CallToolRequestParams, CallToolResponse, CallToolResult, ContentBlock, ErrorData, Implementation, ListToolsResult,
    PaginatedRequestParams, ServerCapabilities, ServerConfig, Tool,
};
use rmcp::service::RequestContext;
use rmcp::{RoleServer, ServerHandler, ServiceExt};
use serde_json::{Map, Value};

use super::error::CliError;
use super::tools::{Answered, TOOLS, ToolFacts};
use crate::scheme::preset::Refines;
use crate::scheme::presets::PRESETS;
use crate::watch::Watch;

/// The instructions for the client about all tools; `SCHEME` is replaced by the name of a preset.
const INSTRUCTIONS: &str = "\
planish refines control polygons and control meshes by subdivision schemes. A job is a JSON object with input, plan, \
levels and outputs, as in {\"input\": {\"mesh\": {\"positions\": [[x,y,z], ...], \"faces\": [[0,1,2,3], ...]}}, \
\"plan\": {\"preset\": \"SCHEME\"}, \"levels\": 3, \"outputs\": [{\"format\": \"png\", \"width\": 600}]}; curves \
have {\"polygon\": {\"points\": [[x,y], ...], \"closed\": true}} as their input. Ask `presets` for the schemes, \
`validate` for what is wrong with a job, `estimate` for what it comes to, `render` for a result and `views` for a look \
from four sides.";

/// Where results go that are no pictures and no short texts.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct McpOptions {
    /// Folder for results that cannot be shown, such as glb and stl; without it the tool refuses them.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl McpOptions {
    /// Serves until the client closes standard input.
    pub(super) fn serve(self) -> Result<(), CliError> {
        if let Some(folder) = &self.out {
            let failed = |error| CliError::files(format!("--out: {} cannot be made: {error}", folder.display()));
            std::fs::create_dir_all(folder).map_err(failed)?;
        }
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build();
        let runtime = runtime.map_err(CliError::other)?;
        let done = runtime.block_on(async {
            let tools = Toolbox { out: self.out.map(Arc::from) };
            let service = tools.serve(rmcp::transport::stdio()).await.map_err(CliError::other)?;
            service.waiting().await.map(drop).map_err(CliError::other)
        });
        // A thread may still be blocked reading standard input.
        runtime.shutdown_background();
        done
    }
}

/// The tools for one client.
#[derive(Debug, Clone)]
struct Toolbox {
    out: Option<Arc<std::path::Path>>,
}

impl ServerHandler for Toolbox {
    fn get_info(&self) -> ServerConfig {
        let capabilities = ServerCapabilities::builder().enable_tools().build();
        let mut config = ServerConfig::new(capabilities);
        config.server_info = Implementation::new("planish", env!("CARGO_PKG_VERSION"));
        let of_meshes = PRESETS.iter().find(|preset| preset.refines == Refines::Meshes);
        let scheme = of_meshes.map_or("", |preset| preset.name);
        config.instructions = Some(INSTRUCTIONS.replace("SCHEME", scheme));
        config
    }

    async fn list_tools(
        &self,
        _: Option<PaginatedRequestParams>,
        _: RequestContext<RoleServer>,
    ) -> Result<ListToolsResult, ErrorData> {
        Ok(ListToolsResult::with_all_items(TOOLS.iter().map(tool).collect()))
    }

    async fn call_tool(
        &self,
        request: CallToolRequestParams,
        context: RequestContext<RoleServer>,
    ) -> Result<CallToolResponse, ErrorData> {
        let Some(facts) = TOOLS.iter().find(|tool| tool.name == request.name) else {
            let names: Vec<&str> = TOOLS.iter().map(|tool| tool.name).collect();
            let detail = format!("there is no tool of this name; there are {}", names.join(", "));
            return Err(ErrorData::invalid_params(detail, None));
        };
        let (watch, arguments) = (Watch::new(), Value::Object(request.arguments.unwrap_or_default()));
        let (of_task, out) = (watch.clone(), self.out.clone());
        let mut running = tokio::task::spawn_blocking(move || facts.run(arguments, out.as_deref(), &of_task));
        let ended = tokio::select! {
            ended = &mut running => ended,
            () = context.ct.cancelled() => {
                watch.stop();
                running.await
            }
        };
        let said =
            ended.unwrap_or_else(|_| Err("the tool failed; this is a fault of planish, please report it".into()));
        Ok(CallToolResponse::from(match said {
            Ok(answers) => CallToolResult::success(answers.into_iter().map(content).collect()),
            Err(detail) => CallToolResult::error(vec![ContentBlock::text(detail)]),
        }))
    }
}

fn tool(facts: &ToolFacts) -> Tool {
    let schema: Map<String, Value> = match (facts.schema)() {
        Value::Object(schema) => schema,
        _ => Map::new(),
    };
    Tool::new(facts.name, facts.doc, Arc::new(schema))
}

fn content(answered: Answered) -> ContentBlock {
    match answered {
        Answered::Text(text) => ContentBlock::text(text),
        Answered::Picture(bytes) => ContentBlock::image(BASE64_STANDARD.encode(bytes), "image/png"),
    }
}
