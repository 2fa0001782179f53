//! A server of the Foxglove WebSocket protocol: the channels of the log, with its messages.

use std::collections::HashMap;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{Context as _, Result};
use coronet::record::log::{Message, Tap};
use foxglove::websocket::{ChannelView, Client, ServerListener};
use foxglove::{Context, PartialMetadata, RawChannel, Schema};

use super::Viewers;
use crate::fault::Usage;
use crate::print::note;

/// What viewers get.
struct Hall {
    context: Arc<Context>,
    /// By topic.
    sent: Mutex<HashMap<String, Sent>>,
}

/// A channel, and the last message on it: that of who comes later.
struct Sent {
    channel: Arc<RawChannel>,
    log_time: u64,
    data: Vec<u8>,
}

impl Hall {
    fn show(&self, message: &Message) -> Result<(), foxglove::FoxgloveError> {
        let mut sent = self.sent.lock().unwrap_or_else(PoisonError::into_inner);
        if !sent.contains_key(message.topic) {
            let schema = Schema::new(message.schema_name, "protobuf", message.schema.to_vec());
            let channel = self.context.channel_builder(message.topic);
            let channel = channel.message_encoding("protobuf").schema(schema);
            let first = Sent {
                channel: channel.build_raw()?,
                log_time: 0,
                data: Vec::new(),
            };
            sent.insert(message.topic.to_string(), first);
        }
        let Some(last) = sent.get_mut(message.topic) else {
            return Ok(());
        };
        last.log_time = message.log_time;
        last.data.clear();
        last.data.extend_from_slice(message.data);
        let meta = PartialMetadata::with_log_time(message.log_time);
        last.channel.log_with_meta(message.data, meta);
        Ok(())
    }
}

impl ServerListener for Hall {
    fn on_subscribe(&self, client: Client, channel: ChannelView) {
        let sent = self.sent.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(last) = sent.get(channel.topic()) {
            let meta = PartialMetadata::with_log_time(last.log_time);
            let sink = client.sink_id();
            last.channel.log_with_meta_to_sink(&last.data, meta, sink);
        }
    }
}

/// Serves at `address`, a socket address; at port 0, any free one.
pub fn start(address: &str) -> Result<Viewers> {
    let place: SocketAddr = address.parse().map_err(|_| {
        Usage(format!(
            "--live={address}: not an address and a port, as {}",
            super::ADDRESS
        ))
    })?;
    let context = Context::new();
    let hall = Arc::new(Hall {
        context: context.clone(),
        sent: Mutex::default(),
    });
    let server = context.websocket_server().name("coronet");
    let server = server.bind(place.ip().to_string(), place.port());
    let server = server.listener(hall.clone()).start_blocking();
    let server = server.with_context(|| {
        format!("--live={address}: cannot serve there; try another port, or 0 for any")
    })?;
    note!(
        "live     ws://{}",
        SocketAddr::new(place.ip(), server.port())
    );
    Ok(Arc::new(move || {
        let hall = hall.clone();
        let tap: Tap = Box::new(move |message| {
            // Who looks on must not stop a run.
            let _ = hall.show(message);
        });
        tap
    }))
}
