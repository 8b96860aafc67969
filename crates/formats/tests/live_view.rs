//! A client of the live view, written out here by Foxglove's websocket protocol.

#![cfg(feature = "live")]
#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::{
    collections::BTreeMap,
    net::{SocketAddr, TcpStream},
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::Duration,
};

use common::{Grey, a_pose, cameras, field};
use foxglove::{
    Decode,
    messages::{CompressedImage, FrameTransform},
};
use reality_sim_formats::{
    PictureFiles,
    show::{LiveView, Shot},
};
use tungstenite::{ClientRequestBuilder, Message, WebSocket, stream::MaybeTlsStream};

/// Client that subscribes to every topic.
struct Client {
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    /// Topics by subscription.
    topics: BTreeMap<u32, String>,
    /// Last payload of each topic.
    received: BTreeMap<String, Vec<u8>>,
}

impl Client {
    fn connect(address: SocketAddr) -> Self {
        let uri = format!("ws://{address}").parse().unwrap();
        let request = ClientRequestBuilder::new(uri).with_sub_protocol("foxglove.sdk.v1");
        let (socket, _) = tungstenite::connect(request).unwrap();
        Self { socket, topics: BTreeMap::new(), received: BTreeMap::new() }
    }

    /// Handles one message of the server.
    fn read(&mut self) {
        match self.socket.read().unwrap() {
            Message::Text(text) => {
                let message: serde_json::Value = serde_json::from_str(&text).unwrap();
                if message["op"] == "advertise" {
                    message["channels"]
                        .as_array()
                        .unwrap()
                        .iter()
                        .for_each(|channel| self.subscribe(channel));
                }
            }
            // Opcode 1 is message data: the subscription, the log time, the payload.
            Message::Binary(bytes) if bytes[0] == 1 => {
                let subscription = u32::from_le_bytes(bytes[1..5].try_into().unwrap());
                self.received.insert(self.topics[&subscription].clone(), bytes[13..].to_vec());
            }
            _ => {}
        }
    }

    fn subscribe(&mut self, channel: &serde_json::Value) {
        let subscription = u32::try_from(self.topics.len() + 1).unwrap();
        self.topics.insert(subscription, channel["topic"].as_str().unwrap().to_owned());
        let subscribe = serde_json::json!({
            "op": "subscribe",
            "subscriptions": [{"id": subscription, "channelId": channel["id"]}],
        });
        self.socket.send(Message::text(subscribe.to_string())).unwrap();
    }
}

#[test]
fn a_client_of_the_live_view_receives_pictures_and_poses() {
    let mut view = LiveView::start("127.0.0.1:0".parse().unwrap()).unwrap();
    let address = view.address();
    let is_done = AtomicBool::new(false);
    thread::scope(|scope| {
        let client = scope.spawn(|| {
            let mut client = Client::connect(address);
            while !["/camera/image", "/tf"].iter().all(|topic| client.received.contains_key(*topic)) {
                client.read();
            }
            is_done.store(true, Ordering::Relaxed);
            client.received
        });
        let (picture, field, camera, pose) = (Grey.bytes(3).unwrap(), field(), &cameras()[3], a_pose());
        view.wait_for_client();
        // The subscription may come late on a busy machine: shown until it has been there.
        for step in 0..3000 {
            if is_done.load(Ordering::Relaxed) {
                break;
            }
            let timestamp_s = 100.0 + 0.02 * f64::from(step);
            view.show(&Shot {
                timestamp_s,
                picture: &picture,
                camera,
                field: &field,
                pose,
                particles: &[pose],
            });
            thread::sleep(Duration::from_millis(1));
        }
        let received = client.join().unwrap();
        let image = CompressedImage::decode(received["/camera/image"].as_slice()).unwrap();
        assert_eq!(image.data.as_ref(), picture.as_slice());
        let transform = FrameTransform::decode(received["/tf"].as_slice()).unwrap();
        assert!((transform.translation.unwrap().x - pose.x_m).abs() < 1e-12);
    });
    view.stop();
}
